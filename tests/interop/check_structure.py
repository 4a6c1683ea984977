"""Checks a recording's structure by the MCAP specification: what the `doctor` of the mcap command line looks at.

Usage: check_structure.py FILE.mcap

Records are parsed by the public Python package; the rules between them are checked here. Everything that is odd fails,
also what a doctor would merely warn of. Ends with status 0 if nothing is.
"""

import io
import sys
import zlib
from collections import Counter

from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode

MAGIC = b"\x89MCAP0\r\n"
FRAME = 9


def fail(message):
    sys.exit(f"structure: {message}")


def expect(found, expected, what):
    if found != expected:
        fail(f"{what}: found {found!r}; expected {expected!r}")


def parsed(kind, body):
    return kind.read(ReadDataStream(io.BytesIO(body)))


def framed(data, start, end):
    """Opcode, place and body of each record."""
    while start < end:
        opcode, length = data[start], int.from_bytes(data[start + 1:start + FRAME], "little")
        if start + FRAME + length > end:
            fail(f"the record at byte {start} is longer than what holds it")
        yield opcode, start, data[start + FRAME:start + FRAME + length]
        start += FRAME + length


class Section:
    """Schemas and channels that a part of the file declares, each once, schemas first."""

    def __init__(self):
        self.schemas, self.channels = {}, {}

    def add_schema(self, schema):
        expect(schema.id != 0 and schema.id not in self.schemas, True, f"new number of schema {schema.id}")
        expect(schema.encoding, "protobuf", f"encoding of schema {schema.name}")
        self.schemas[schema.id] = schema

    def add_channel(self, channel):
        expect(channel.id in self.channels, False, f"channel {channel.id} declared before")
        expect(channel.schema_id in self.schemas, True, f"schema of channel {channel.topic} declared")
        self.channels[channel.id] = channel


class Structure:
    def __init__(self, data):
        self.data = data
        self.declared, self.summary = Section(), Section()
        self.chunks, self.chunk_indexes = {}, []
        self.message_counts = Counter()
        self.first, self.last = None, 0
        self.statistics = []
        self.attachments = self.metadata = 0

    def check(self):
        data = self.data
        expect((data[:8], data[-8:]), (MAGIC, MAGIC), "first and last bytes")
        ended, footer, open_chunk = None, None, None
        for opcode, start, body in framed(data, len(MAGIC), len(data) - len(MAGIC)):
            if start == len(MAGIC):
                expect(opcode, Opcode.HEADER, "first record")
                header = parsed(records.Header, body)
                expect((header.profile, header.library.startswith("roverlab")), ("", True), "profile and library")
            elif footer:
                fail(f"a record at byte {start}, behind the footer")
            elif opcode == Opcode.DATA_END:
                crc = parsed(records.DataEnd, body).data_section_crc
                expect(crc, zlib.crc32(data[:start]), "checksum of the data")
                ended = start + FRAME + len(body)
            elif opcode == Opcode.FOOTER:
                footer = parsed(records.Footer, body)
                expect(footer.summary_start, ended, "start of the summary")
                expect(footer.summary_crc, zlib.crc32(data[ended:start + FRAME + 16]), "checksum of the summary")
            elif ended:
                self.in_summary(opcode, body)
            elif opcode == Opcode.CHUNK:
                open_chunk = self.chunk(start, body)
            elif opcode == Opcode.MESSAGE_INDEX:
                self.message_index(open_chunk, start, parsed(records.MessageIndex, body))
            elif opcode in (Opcode.ATTACHMENT, Opcode.METADATA):
                self.attachments += opcode == Opcode.ATTACHMENT
                self.metadata += opcode == Opcode.METADATA
            else:
                fail(f"a record of kind {opcode} outside of chunks at byte {start}")
        expect(footer is not None, True, "footer present")
        self.compare()

    def in_summary(self, opcode, body):
        if opcode == Opcode.SCHEMA:
            self.summary.add_schema(parsed(records.Schema, body))
        elif opcode == Opcode.CHANNEL:
            self.summary.add_channel(parsed(records.Channel, body))
        elif opcode == Opcode.CHUNK_INDEX:
            self.chunk_indexes.append(parsed(records.ChunkIndex, body))
        elif opcode == Opcode.STATISTICS:
            self.statistics.append(parsed(records.Statistics, body))
        elif opcode not in (Opcode.ATTACHMENT_INDEX, Opcode.METADATA_INDEX, Opcode.SUMMARY_OFFSET):
            fail(f"a record of kind {opcode} in the summary")

    def chunk(self, start, body):
        chunk = parsed(records.Chunk, body)
        expect(chunk.compression, "", "compression")
        expect(chunk.uncompressed_size, len(chunk.data), "size of a chunk")
        expect(chunk.uncompressed_crc, zlib.crc32(chunk.data), "checksum of a chunk")
        messages, times = {}, []
        for opcode, at, inner in framed(chunk.data, 0, len(chunk.data)):
            if opcode == Opcode.SCHEMA:
                self.declared.add_schema(parsed(records.Schema, inner))
            elif opcode == Opcode.CHANNEL:
                self.declared.add_channel(parsed(records.Channel, inner))
            elif opcode == Opcode.MESSAGE:
                message = records.Message.read(ReadDataStream(io.BytesIO(inner)), len(inner))
                topic = self.declared.channels.get(message.channel_id)
                expect(topic is not None, True, f"channel {message.channel_id} declared before its messages")
                expect(message.sequence, self.message_counts[message.channel_id], f"sequence on {topic.topic}")
                expect(message.log_time >= self.last, True, f"messages in the order of their time on {topic.topic}")
                self.last = message.log_time
                self.first = self.last if self.first is None else self.first
                self.message_counts[message.channel_id] += 1
                messages.setdefault(message.channel_id, []).append((message.log_time, at))
                times.append(message.log_time)
            else:
                fail(f"a record of kind {opcode} in the chunk at byte {start}")
        expect((chunk.message_start_time, chunk.message_end_time), (min(times), max(times)), "times of a chunk")
        entry = (chunk, FRAME + len(body), messages, {})
        self.chunks[start] = entry
        return entry

    def message_index(self, entry, start, index):
        expect(entry is not None, True, "a chunk before its index")
        expect(index.channel_id in entry[3], False, "index of a channel twice")
        expect([tuple(record) for record in index.records], entry[2].get(index.channel_id), "index of messages")
        entry[3][index.channel_id] = start

    def compare(self):
        """The summary says what the data holds."""
        expect(self.summary.schemas, self.declared.schemas, "schemas in the summary")
        expect(self.summary.channels, self.declared.channels, "channels in the summary")
        expect([index.chunk_start_offset for index in self.chunk_indexes], sorted(self.chunks), "index of chunks")
        for index in self.chunk_indexes:
            chunk, length, messages, indexes = self.chunks[index.chunk_start_offset]
            expect(index.chunk_length, length, "length of a chunk in its index")
            expect(index.message_index_offsets, indexes, "places of the indexes of a chunk")
            expect(sorted(indexes), sorted(messages), "channels that a chunk indexes")
            found = (index.message_start_time, index.message_end_time, index.compression)
            expect(found, (chunk.message_start_time, chunk.message_end_time, chunk.compression), "index of a chunk")
            sizes = (index.compressed_size, index.uncompressed_size)
            expect(sizes, (len(chunk.data), chunk.uncompressed_size), "sizes of a chunk in its index")
        expect(len(self.statistics), 1, "records of statistics")
        told = self.statistics[0]
        expect(told.message_count, sum(self.message_counts.values()), "messages in the statistics")
        expect(told.channel_message_counts, dict(self.message_counts), "messages by channel in the statistics")
        found = (told.schema_count, told.channel_count, told.chunk_count, told.attachment_count, told.metadata_count)
        counted = (len(self.declared.schemas), len(self.declared.channels), len(self.chunks), self.attachments, self.metadata)
        expect(found, counted, "counts in the statistics")
        expect((told.message_start_time, told.message_end_time), (self.first, self.last), "times in the statistics")


def main():
    with open(sys.argv[1], "rb") as source:
        structure = Structure(source.read())
    structure.check()
    count = sum(structure.message_counts.values())
    print(f"structure: {len(structure.chunks)} chunks with {count} messages, nothing is odd")


main()
