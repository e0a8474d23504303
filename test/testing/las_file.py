"""Reads LAS files as the ASPRS specification (1.2, and 1.4 - R15) describes them.

It shares nothing with the writer, and is strict: what the specification asks of a header is
asserted.
"""

import struct

import numpy

# Table 24: types of extra bytes.
EXTRA_TYPES = {1: "u1", 2: "i1", 3: "<u2", 4: "<i2", 5: "<u4", 6: "<i4", 7: "<u8", 8: "<i8",
               9: "<f4", 10: "<f8"}
FORMAT_3 = [("X", "<i4"), ("Y", "<i4"), ("Z", "<i4"), ("intensity", "<u2"), ("returns", "u1"),
            ("classification", "u1"), ("scan_angle", "i1"), ("user_data", "u1"),
            ("source", "<u2"), ("gps_time", "<f8"), ("red", "<u2"), ("green", "<u2"),
            ("blue", "<u2")]
FORMAT_7 = [("X", "<i4"), ("Y", "<i4"), ("Z", "<i4"), ("intensity", "<u2"), ("returns", "u1"),
            ("flags", "u1"), ("classification", "u1"), ("user_data", "u1"),
            ("scan_angle", "<i2"), ("source", "<u2"), ("gps_time", "<f8"), ("red", "<u2"),
            ("green", "<u2"), ("blue", "<u2")]


def text_of(field):
    text, _, rest = field.partition(b"\0")
    assert not rest.strip(b"\0"), "text with something after its end"
    return text.decode("ascii")


class LasFile:
    """`header` by the specification's names, `records` {(user, number): bytes}, `points`."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.bytes = file.read()
        self.header = self.read_header()
        self.records = self.read_records()
        self.points = self.read_points()
        self.check_bounds_and_counts()

    def read_header(self):
        names = ("signature source_id global_encoding guid major minor system software day year "
                 "header_size points_offset num_records point_format point_size legacy_points "
                 "legacy_returns scale offset bounds").split()
        values = list(struct.unpack_from("<4sHH16sBB32s32sHHHIIBHI", self.bytes))
        at = struct.calcsize("<4sHH16sBB32s32sHHHIIBHI")
        for count, code in ((5, "I"), (3, "d"), (3, "d"), (6, "d")):
            values.append(struct.unpack_from(f"<{count}{code}", self.bytes, at))
            at += struct.calcsize(f"<{count}{code}")
        assert at == 227
        header = dict(zip(names, values))
        assert header["signature"] == b"LASF" and header["major"] == 1
        header["software"] = text_of(header["software"])
        header["system"] = text_of(header["system"])
        header["num_points"] = header["legacy_points"]
        header["returns"] = header["legacy_returns"]
        if header["minor"] == 2:
            assert header["header_size"] == 227
            assert header["global_encoding"] & ~1 == 0, "bits that 1.2 reserves"
        else:
            assert header["minor"] == 4 and header["header_size"] == 375
            (header["waves"], header["first_extended"], header["num_extended"],
             header["num_points"]) = struct.unpack_from("<QQIQ", self.bytes, 227)
            header["returns"] = struct.unpack_from("<15Q", self.bytes, 255)
            assert header["waves"] == header["first_extended"] == header["num_extended"] == 0
            if header["point_format"] >= 6:
                assert header["legacy_points"] == 0 and not any(header["legacy_returns"])
                assert header["global_encoding"] & 16, "formats from 6 on need a WKT"
        return header

    def read_records(self):
        records, at = {}, self.header["header_size"]
        for _ in range(self.header["num_records"]):
            reserved, user, number, size, _ = struct.unpack_from("<H16sHH32s", self.bytes, at)
            assert reserved == 0
            at += 54
            records[text_of(user), number] = self.bytes[at:at + size]
            at += size
        assert at == self.header["points_offset"]
        return records

    def extra_fields(self):
        content = self.records.get(("LASF_Spec", 4), b"")
        assert len(content) % 192 == 0
        fields = []
        for at in range(0, len(content), 192):
            reserved, kind, options, name = struct.unpack_from("<2sBB32s", content, at)
            assert reserved == b"\0\0" and options == 0
            assert not content[at + 36:at + 160].strip(b"\0"), "unused fields are zero"
            text_of(content[at + 160:at + 192])
            fields.append((text_of(name), EXTRA_TYPES[kind]))
        return fields

    def read_points(self):
        fields = {3: FORMAT_3, 7: FORMAT_7}[self.header["point_format"]] + self.extra_fields()
        kind = numpy.dtype(fields)
        assert kind.itemsize == self.header["point_size"]
        data = self.bytes[self.header["points_offset"]:]
        assert len(data) == kind.itemsize * self.header["num_points"]
        return numpy.frombuffer(data, kind)

    def coordinates(self):
        """n x 3, m"""
        integers = numpy.stack([self.points[name] for name in "XYZ"], axis=1)
        return integers * numpy.array(self.header["scale"]) + numpy.array(self.header["offset"])

    def check_bounds_and_counts(self):
        num_bits = 3 if self.header["point_format"] < 6 else 4
        mask = (1 << num_bits) - 1
        number = self.points["returns"] & mask
        total = (self.points["returns"] >> num_bits) & mask
        assert (number >= 1).all() and (number <= total).all()
        counts = [int((number == i + 1).sum()) for i in range(len(self.header["returns"]))]
        assert list(self.header["returns"]) == counts, "points by return"
        if len(self.points):
            p = self.coordinates()
            bounds = numpy.stack([p.max(axis=0), p.min(axis=0)], axis=1).ravel()
        else:
            bounds = numpy.zeros(6)
        assert numpy.allclose(self.header["bounds"], bounds, rtol=0, atol=1e-9), "bounding box"
