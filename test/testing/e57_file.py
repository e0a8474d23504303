"""Reads E57 files with one scan as ASTM E2807 describes them, checksums included.

It shares nothing with the writer. Integers of whole bytes only.
"""

import struct
import xml.etree.ElementTree

import numpy

NAMESPACE = "{http://www.astm.org/COMMIT/E57/2010-e57-v1.0}"
PAGE = 1024


def crc32c_table():
    table = []
    for value in range(256):
        for _ in range(8):
            value = (value >> 1) ^ (0x82F63B78 if value & 1 else 0)
        table.append(value)
    return table


TABLE = crc32c_table()


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc = (crc >> 8) ^ TABLE[(crc ^ byte) & 0xFF]
    return crc ^ 0xFFFFFFFF


assert crc32c(b"123456789") == 0xE3069283


class E57File:
    """`root`: the XML element; `points`: {name without namespace: values}."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        (signature, major, minor, size, xml_offset, xml_size, page) = struct.unpack_from(
            "<8sIIQQQQ", data)
        assert signature == b"ASTM-E57" and (major, minor) == (1, 0) and page == PAGE
        assert size == len(data) and size % PAGE == 0
        self.logical = b"".join(self.payload(data[at:at + PAGE]) for at in range(0, size, PAGE))
        at = self.logical_offset(xml_offset)
        assert xml_offset % 4 == 0
        self.root = xml.etree.ElementTree.fromstring(self.logical[at:at + xml_size])
        assert not self.logical[at + xml_size:].strip(b"\0"), "something after the XML"
        self.points = self.read_points()

    @staticmethod
    def payload(page):
        assert crc32c(page[:-4]) == struct.unpack(">I", page[-4:])[0], "checksum of a page"
        return page[:-4]

    @staticmethod
    def logical_offset(physical):
        assert physical % PAGE < PAGE - 4
        return physical // PAGE * (PAGE - 4) + physical % PAGE

    def find(self, path):
        found = self.root.find("/".join(NAMESPACE + name for name in path.split("/")))
        assert found is not None, path
        return found

    def read_points(self):
        vector = self.find("data3D/vectorChild/points")
        start = self.logical_offset(int(vector.get("fileOffset")))
        kind, length, data_offset, index_offset = struct.unpack_from("<B7xQQQ", self.logical, start)
        assert kind == 1 and index_offset == 0 and length % 4 == 0
        fields = list(self.find("data3D/vectorChild/points/prototype"))
        columns = [b""] * len(fields)
        at, end = self.logical_offset(data_offset), start + length
        while at < end:
            packet, flags, size_minus_1, num_streams = struct.unpack_from("<BBHH", self.logical, at)
            assert packet == 1 and flags == 0 and (size_minus_1 + 1) % 4 == 0
            assert num_streams == len(fields)
            sizes = struct.unpack_from(f"<{num_streams}H", self.logical, at + 6)
            data = at + 6 + 2 * num_streams
            for i, size in enumerate(sizes):
                columns[i] += self.logical[data:data + size]
                data += size
            at += size_minus_1 + 1
            assert 0 <= at - data < 4, "only padding follows"
        assert at == end
        points = {field.tag.split("}")[1]: self.values(field, column)
                  for field, column in zip(fields, columns)}
        for values in points.values():
            assert len(values) == int(vector.get("recordCount"))
        return points

    @staticmethod
    def values(field, column):
        if field.get("type") == "Float":
            return numpy.frombuffer(column, "<f4" if field.get("precision") == "single" else "<f8")
        assert field.get("type") == "Integer"
        low, high = int(field.get("minimum")), int(field.get("maximum"))
        num_bits = (high - low).bit_length()
        assert num_bits % 8 == 0
        return numpy.frombuffer(column, f"<u{num_bits // 8}").astype(numpy.int64) + low
