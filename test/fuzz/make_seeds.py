#!/usr/bin/python3
"""Writes small bags that the fuzzer of the bag reader begins with: make_seeds.py FOLDER

Each has two scanners with a few scan lines of three beams, and definitions of types left out.
"""

import bz2
import ctypes
import pathlib
import struct
import sys

LASER_SCAN = ("sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369")
MULTI_ECHO = ("sensor_msgs/MultiEchoLaserScan", "6fefb0c6da89d7c8abe4b339f5c2f8fb")
START_S = 1600000000


def fields(**values):
    packed = b""
    for name, value in values.items():
        field = name.encode() + b"=" + value
        packed += struct.pack("<I", len(field)) + field
    return packed


def record(data, **values):
    header = fields(**values)
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data


def u32(value):
    return struct.pack("<I", value)


def u64(value):
    return struct.pack("<Q", value)


def lz4(data):
    library = ctypes.CDLL("liblz4.so.1")
    library.LZ4F_compressFrameBound.restype = ctypes.c_size_t
    library.LZ4F_compressFrame.restype = ctypes.c_size_t
    space = library.LZ4F_compressFrameBound(ctypes.c_size_t(len(data)), None)
    packed = ctypes.create_string_buffer(space)
    size = library.LZ4F_compressFrame(packed, ctypes.c_size_t(space), data,
                                      ctypes.c_size_t(len(data)), None)
    return packed.raw[:size]


PACKERS = {"none": lambda data: data, "bz2": bz2.compress, "lz4": lz4}


def scan(i, multi_echo):
    message = struct.pack("<III", i, START_S, 25000000 * i) + u32(5) + b"laser"
    message += struct.pack("<7f", -0.5, 0.5, 0.5, 0.001, 0.025, 0.1, 30.0)
    if multi_echo:
        message += u32(3) + struct.pack("<IfIIff", 1, 1.0, 0, 2, 2.0, 3.0) + u32(0)
    else:
        message += u32(3) + struct.pack("<3f", 1.0, 2.0, 3.0) + u32(0)
    return message


def connections(multi_echo):
    type_name, md5sum = MULTI_ECHO if multi_echo else LASER_SCAN
    return [record(fields(topic=topic, type=type_name.encode(), md5sum=md5sum.encode(),
                          message_definition=b""),
                   conn=u32(i), op=b"\7", topic=topic)
            for i, topic in enumerate((b"/top_scan", b"/left_scan"))]


def bag(compression, multi_echo=False, closed=True, num_chunks=2, scans_per_chunk=2):
    def header(index_position):
        return b"#ROSBAG V2.0\n" + record(
            b" " * 16, chunk_count=u32(num_chunks if closed else 0),
            conn_count=u32(2 if closed else 0), index_pos=u64(index_position), op=b"\3")

    body = b""
    chunk_infos = b""
    for chunk in range(num_chunks):
        content = b"".join(connections(multi_echo)) if chunk == 0 else b""
        entries = {0: b"", 1: b""}
        time = struct.pack("<II", START_S, 0)
        for i in range(chunk * scans_per_chunk, (chunk + 1) * scans_per_chunk):
            for conn in entries:
                time = struct.pack("<II", START_S, 25000000 * i + conn)
                entries[conn] += time + u32(len(content))
                content += record(scan(i, multi_echo), conn=u32(conn), op=b"\2", time=time)
        chunk_infos += record(
            b"".join(u32(conn) + u32(scans_per_chunk) for conn in entries),
            chunk_pos=u64(len(header(0)) + len(body)), count=u32(2), end_time=time, op=b"\6",
            start_time=time, ver=u32(1))
        body += record(PACKERS[compression](content), compression=compression.encode(),
                       op=b"\5", size=u32(len(content)))
        for conn, data in entries.items():
            body += record(data, conn=u32(conn), count=u32(scans_per_chunk), op=b"\4",
                           ver=u32(1))
    if not closed:
        return header(0) + body
    index_position = len(header(0)) + len(body)
    return header(index_position) + body + b"".join(connections(multi_echo)) + chunk_infos


def main(folder):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for compression in PACKERS:
        (folder / f"{compression}.bag").write_bytes(bag(compression))
    (folder / "multi_echo.bag").write_bytes(bag("none", multi_echo=True))
    (folder / "not_closed.bag").write_bytes(bag("none", closed=False))
    (folder / "cut.bag").write_bytes(bag("none")[:1100])
    (folder / "cut_bz2.bag").write_bytes(bag("bz2")[:700])
    (folder / "empty.bag").write_bytes(bag("none", num_chunks=1, scans_per_chunk=0))


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1] == "--help":
        print(__doc__)
        sys.exit(0 if "--help" in sys.argv else 2)
    main(sys.argv[1])
