"""read_recordings.py TABLE.csv [FILE.npz|FILE.mcap]...: each file says what the table says, to the last bit.

    --cut FILE.mcap TABLE.csv   what is left of a recording that was cut off: whole chunks, which the table begins with

Written by the specifications of ZIP, NPY, MCAP (mcap.dev/spec), OMG's CDR and ROS 2's message definitions, with nothing but
Python's own library, so that it shares no mistake with what wrote the files. Where numpy is there it reads the .npz too.
"""

import ast
import csv
import os
import re
import struct
import sys
import zipfile
import zlib

MAGIC = b"\x89MCAP0\r\n"


def bits(x):
    return "nan" if x != x else struct.pack("<d", x)


def read_table(path):
    with open(path, newline="", encoding="utf-8") as lines:
        rows = list(csv.reader(lines))
    words = ("sample", "device", "fault")
    columns = {}
    for i, name in enumerate(rows[0]):
        texts = [row[i] for row in rows[1:]]
        columns[name] = texts if name in words else [float(t) for t in texts]
    return columns


def expect(what, told, wanted):
    if told != wanted:
        raise SystemExit(f"{what}: {told!r} instead of {wanted!r}")


def expect_column(where, name, told, wanted):
    expect(f"{where}: rows of {name}", len(told), len(wanted))
    for row, (a, b) in enumerate(zip(told, wanted)):
        same = a == b if isinstance(b, str) else bits(a) == bits(b)
        if not same:
            raise SystemExit(f"{where}: {name} of row {row} is {a!r} instead of {b!r}")


# --- .npz ---


def read_npy(data):
    expect("magic of .npy", data[:8], b"\x93NUMPY\x01\x00")
    (length,) = struct.unpack_from("<H", data, 8)
    expect("alignment of .npy", (10 + length) % 64, 0)
    header = ast.literal_eval(data[10 : 10 + length].decode("latin-1"))
    expect("order of .npy", header["fortran_order"], False)
    (rows,) = header["shape"]
    body = data[10 + length :]
    if header["descr"] == "<f8":
        return list(struct.unpack(f"<{rows}d", body))
    width = int(re.fullmatch(r"<U(\d+)", header["descr"]).group(1))
    expect("size of .npy", len(body), 4 * width * rows)
    texts = []
    for row in range(rows):
        texts.append(body[4 * width * row : 4 * width * (row + 1)].decode("utf-32-le").rstrip("\0"))
    return texts


def check_npz(path, table):
    with zipfile.ZipFile(path) as archive:
        expect(f"{path}: damaged entries", archive.testzip(), None)
        expect(f"{path}: entries", archive.namelist(), [name + ".npy" for name in table])
        for name in table:
            expect_column(path, name, read_npy(archive.read(name + ".npy")), table[name])
    try:
        import numpy
    except ImportError:
        print(f"{path}: not read by numpy, which is not here")
        return
    with numpy.load(path, allow_pickle=False) as archive:
        expect(f"{path}: columns", archive.files, list(table))
        for name in table:
            expect_column(path, name, archive[name].tolist(), table[name])


# --- .mcap ---


class Reader:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, n):
        if self.at + n > len(self.data):
            raise EOFError
        self.at += n
        return self.data[self.at - n : self.at]

    def number(self, kind):
        return struct.unpack("<" + kind, self.take(struct.calcsize("<" + kind)))[0]

    def text(self):
        return self.take(self.number("I")).decode("utf-8")

    def block(self):
        return Reader(self.take(self.number("I")))

    def more(self):
        return self.at < len(self.data)

    def pairs(self, key, value):
        block, out = self.block(), {}
        while block.more():
            k = key(block)
            if k in out:
                raise SystemExit(f"the key {k!r} is there twice")
            out[k] = value(block)
        return out


def u16(r):
    return r.number("H")


def u64(r):
    return r.number("Q")


def records(reader):
    """(offset, opcode, content) of each whole record."""
    while reader.more():
        at = reader.at
        try:
            kind = reader.number("B")
            content = reader.take(reader.number("Q"))
        except EOFError:
            return
        yield at, kind, content


class Schemas:
    """Message definitions, as ros2msg puts them one behind the other."""

    numbers = {"float64": "d", "int32": "i", "uint32": "I"}

    def __init__(self, name, text):
        parts = re.split(r"^={80}\n", text, flags=re.M)
        self.types = {re.sub("/msg/", "/", name): self.fields(parts[0])}
        self.root = re.sub("/msg/", "/", name)
        for part in parts[1:]:
            head, body = part.split("\n", 1)
            self.types[re.fullmatch(r"MSG: (\S+)", head).group(1)] = self.fields(body)

    @staticmethod
    def fields(text):
        return [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]

    def find(self, kind, inside):
        for name in (kind, inside.split("/")[0] + "/" + kind):
            if name in self.types:
                return name
        raise SystemExit(f"{kind}, which {inside} has, is not defined")

    def decode(self, data):
        expect("encapsulation of CDR", data[:4], b"\x00\x01\x00\x00")
        reader = Reader(data[4:])
        out = self.struct(reader, self.root)
        expect("bytes behind a message", len(reader.data) - reader.at, 0)
        return out

    def struct(self, reader, name):
        out = {}
        for kind, field in self.types[name]:
            if kind in self.numbers:
                out[field] = self.number(reader, self.numbers[kind])
            elif kind == "string":
                length = self.number(reader, "I")
                text = reader.take(length)
                expect("end of a string", text[-1:], b"\0")
                out[field] = text[:-1].decode("utf-8")
            else:
                out[field] = self.struct(reader, self.find(kind, name))
        return out

    @staticmethod
    def number(reader, kind):
        size = struct.calcsize("<" + kind)
        pad = reader.take(-reader.at % size)
        expect("padding", pad.strip(b"\0"), b"")
        return reader.number(kind)


class Bag:
    def __init__(self):
        self.schemas, self.channels, self.messages, self.chunks = {}, {}, [], []

    def schema(self, content):
        r = Reader(content)
        number, name, encoding = u16(r), r.text(), r.text()
        expect("encoding of a schema", encoding, "ros2msg")
        made = (name, r.text())
        expect("a schema told again", self.schemas.setdefault(number, made), made)

    def channel(self, content):
        r = Reader(content)
        number, schema, topic, encoding = u16(r), u16(r), r.text(), r.text()
        expect("encoding of a channel", encoding, "cdr")
        metadata = r.pairs(Reader.text, Reader.text)
        expect("metadata of a channel", list(metadata), ["offered_qos_profiles"])
        if schema not in self.schemas:
            raise SystemExit(f"{topic} is told before its schema")
        made = (topic, schema)
        expect("a channel told again", self.channels.setdefault(number, made), made)

    def message(self, content):
        r = Reader(content)
        channel, sequence, logged, published = u16(r), r.number("I"), u64(r), u64(r)
        expect("time of a message", published, logged)
        if channel not in self.channels:
            raise SystemExit("a message comes before its channel")
        self.messages.append((channel, sequence, logged, content[22:]))

    def chunk(self, content):
        r = Reader(content)
        first, last, size, crc = u64(r), u64(r), u64(r), r.number("I")
        expect("compression", r.text(), "")
        data = r.take(u64(r))
        expect("size of a chunk", len(data), size)
        expect("checksum of a chunk", zlib.crc32(data), crc)
        before = len(self.messages)
        where = {}
        inside = Reader(data)
        for at, kind, message in records(inside):
            expect("record in a chunk", kind, 5)
            self.message(message)
            where.setdefault(self.messages[-1][0], []).append((self.messages[-1][2], at))
        expect("bytes behind the last record of a chunk", inside.at, len(data))
        times = [m[2] for m in self.messages[before:]]
        expect("times of a chunk", (first, last), (min(times), max(times)))
        self.chunks.append({"times": (first, last), "size": size, "where": where})


def read_data_section(data, bag, ended):
    expect("magic", data[:8], MAGIC)
    reader = Reader(data)
    reader.at = 8
    for at, kind, content in records(reader):
        if kind == 1:
            r = Reader(content)
            expect("profile", r.text(), "ros2")
            if not r.text().startswith("asperity "):
                raise SystemExit("the library is not named")
        elif kind == 3:
            bag.schema(content)
        elif kind == 4:
            bag.channel(content)
        elif kind == 6:
            bag.chunk(content)
            bag.chunks[-1].update(at=at, length=9 + len(content), indexes={}, index_length=0)
        elif kind == 7:
            r = Reader(content)
            channel, block = u16(r), r.block()
            entries = []
            while block.more():
                entries.append((u64(block), u64(block)))
            expect("message index", entries, bag.chunks[-1]["where"][channel])
            bag.chunks[-1]["indexes"][channel] = at
            bag.chunks[-1]["index_length"] += 9 + len(content)
        elif kind == 15 and ended:
            expect("checksum of the data", Reader(content).number("I"), zlib.crc32(data[:at]))
            return reader.at
        else:
            raise SystemExit(f"a record of kind {kind} at {at}")
    if ended:
        raise SystemExit("the data section does not end")
    return reader.at


def read_summary(data, start, bag):
    expect("magic at the end", data[-8:], MAGIC)
    footer = len(data) - 8 - 29
    r = Reader(data)
    r.at = footer
    expect("footer", (r.number("B"), u64(r)), (2, 20))
    summary, offsets, crc = u64(r), u64(r), r.number("I")
    expect("begin of the summary", summary, start)
    expect("checksum of the summary", zlib.crc32(data[summary : footer + 25]), crc)
    groups, told = {}, []
    again = Bag()
    indexed = []
    for at, kind, content in iter_from(data, summary, footer):
        r = Reader(content)
        if kind == 14:
            told.append((r.number("B"), u64(r), u64(r)))
            if at < offsets:
                raise SystemExit("a summary offset stands among the summary")
            continue
        if at >= offsets:
            raise SystemExit("the summary goes on behind its offsets")
        first, length = groups.get(kind, (at, 0))
        expect("records of a kind stand together", first + length, at)
        groups[kind] = (first, length + 9 + len(content))
        if kind == 3:
            again.schema(content)
        elif kind == 4:
            again.channel(content)
        elif kind == 8:
            times = (u64(r), u64(r))
            where, length = u64(r), u64(r)
            of_messages = r.pairs(u16, u64)
            indexed.append((times, where, length, of_messages, u64(r), r.text(), u64(r), u64(r)))
        elif kind == 11:
            counts = (u64(r), u16(r), r.number("I"), r.number("I"), r.number("I"), r.number("I"))
            messages = bag.messages
            expect("counts", counts, (len(messages), len(bag.schemas), len(bag.channels), 0, 0, len(bag.chunks)))
            times = [m[2] for m in messages] or [0]
            expect("times", (u64(r), u64(r)), (min(times), max(times)))
            per = {c: sum(1 for m in messages if m[0] == c) for c in bag.channels}
            expect("messages by channel", r.pairs(u16, u64), per)
        else:
            raise SystemExit(f"a record of kind {kind} in the summary")
    expect("schemas and channels again", (again.schemas, again.channels), (bag.schemas, bag.channels))
    expect("summary offsets", sorted(told), sorted((k, a, n) for k, (a, n) in groups.items()))
    expect("statistics", 11 in groups, True)
    wanted = [
        (c["times"], c["at"], c["length"], c["indexes"], c["index_length"], "", c["size"], c["size"]) for c in bag.chunks
    ]
    expect("chunk indexes", indexed, wanted)


def iter_from(data, begin, end):
    reader = Reader(data[:end])
    reader.at = begin
    return records(reader)


POSES = {"/asperity/device/pose": "device", "/asperity/probe/pose": "probe"}
WRENCHES = {"/asperity/contact/wrench": "contact", "/asperity/hand/wrench": "hand"}
FRAMES = {"/asperity/device/pose": "device", "/asperity/hand/wrench": "device"}


def columns_of(bag):
    """The columns of a table from the decoded messages."""
    out = {}
    decoders = {number: Schemas(*schema) for number, schema in bag.schemas.items()}

    def put(name, value):
        out.setdefault(name, []).append(value)

    for channel, sequence, logged, data in bag.messages:
        topic, schema = bag.channels[channel]
        m = decoders[schema].decode(data)
        stamp = m["header"]["stamp"]
        expect("stamp", stamp["sec"] * 10**9 + stamp["nanosec"], logged)
        expect("frame", m["header"]["frame_id"], FRAMES.get(topic, "world"))
        if topic in POSES:
            who, p = POSES[topic], m["pose"]
            for axis in "xyz":
                put(f"{who}_{axis}_m", p["position"][axis])
            for axis in "xyzw":
                put(f"{who}_q{axis}", p["orientation"][axis])
        elif topic in WRENCHES:
            who, w = WRENCHES[topic], m["wrench"]
            for axis in "xyz":
                put(f"{who}_f{axis}_n", w["force"][axis])
                put(f"{who}_t{axis}_n_m", w["torque"][axis])
        else:
            expect("topic", topic, "/asperity/tick")
            expect("sequence", sequence, len(out.get("time_s", [])))
            put("time_s", logged / 1e9)
            for name, value in m.items():
                if name != "header":
                    put(name, value)
    return out


def check_metadata(path, bag):
    with open(os.path.join(os.path.dirname(path), "metadata.yaml"), encoding="utf-8") as text:
        told = text.read()
    name, times = os.path.basename(path), [m[2] for m in bag.messages] or [0]
    try:
        import yaml
    except ImportError:
        expect("file in metadata.yaml", f"- '{name}'" in told, True)
        expect("messages in metadata.yaml", f"\n  message_count: {len(bag.messages)}\n" in told, True)
        return
    info = yaml.safe_load(told)["rosbag2_bagfile_information"]
    expect("storage", (info["version"], info["storage_identifier"]), (5, "mcap"))
    expect("files", info["relative_file_paths"], [name])
    expect("messages", info["message_count"], len(bag.messages))
    expect("duration", info["duration"]["nanoseconds"], max(times) - min(times))
    expect("start", info["starting_time"]["nanoseconds_since_epoch"], min(times))
    for t in info["topics_with_message_count"]:
        count = sum(1 for m in bag.messages if bag.channels[m[0]][0] == t["topic_metadata"]["name"])
        expect("messages of a topic", t["message_count"], count)
        expect("serialization", t["topic_metadata"]["serialization_format"], "cdr")
    kinds = {t["topic_metadata"]["name"]: t["topic_metadata"]["type"] for t in info["topics_with_message_count"]}
    expect("topics", kinds, {t: bag.schemas[s][0] for t, s in bag.channels.values()})
    expect("file", info["files"][0]["message_count"], len(bag.messages))


def check_mcap(path, table):
    with open(path, "rb") as file:
        data = file.read()
    bag = Bag()
    start = read_data_section(data, bag, ended=True)
    read_summary(data, start, bag)
    told = columns_of(bag)
    if not table["time_s"]:
        expect("messages", bag.messages, [])
    else:
        expect("columns", sorted(told), sorted(table))
        for name in table:
            expect_column(path, name, told[name], table[name])
    check_metadata(path, bag)
    return len(bag.messages)


def check_cut(path, table):
    with open(path, "rb") as file:
        data = file.read()
    bag = Bag()
    end = read_data_section(data, bag, ended=False)
    told = columns_of(bag)
    rows = len(told.get("time_s", []))
    for name in told:
        expect_column(path, name, told[name], table[name][:rows])
    print(f"{rows} rows of {len(table['time_s'])}, {len(data) - end} bytes of a record that was cut")


def main(arguments):
    if arguments[0] == "--cut":
        check_cut(arguments[1], read_table(arguments[2]))
        return
    table = read_table(arguments[0])
    for path in arguments[1:]:
        if path.endswith(".npz"):
            check_npz(path, table)
        else:
            check_mcap(path, table)
        print(f"{path}: {len(table['time_s'])} rows, the same")


if __name__ == "__main__":
    main(sys.argv[1:])
