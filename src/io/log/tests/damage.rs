//! Files that are truncated, damaged, concatenated, or from another version.

use std::collections::BTreeMap;
use std::io;

use proptest::prelude::*;

use super::*;

/// A recording of a few kilobytes.
fn small(seconds: f64) -> Vec<u8> {
    recorded_by(|robot| blind_tour(robot, seconds))
}

/// A file with several of this project's metadata records.
fn with_metadata(records: &[&[(&str, &str)]]) -> Vec<u8> {
    let mut file = mcap::Writer::new(io::Cursor::new(Vec::new())).unwrap();
    for fields in records {
        let metadata = fields.iter().map(|&(name, value)| (name.to_owned(), value.to_owned()));
        let metadata: BTreeMap<_, _> = metadata.collect();
        file.write_metadata(&mcap::records::Metadata { name: "roverlab".into(), metadata }).unwrap();
    }
    file.finish().unwrap();
    file.into_inner().into_inner()
}

#[test]
fn several_runs_and_newer_schemas_are_named() {
    let named = |records: &[&[(&str, &str)]]| Log::read(with_metadata(records)).unwrap_err();
    assert!(matches!(named(&[&[("schema", "2")]]), LogError::Newer { found: 2, supported: 1 }));
    // It is recovered as it is, header included.
    let newer = recover(&with_metadata(&[&[("schema", "2")]])).unwrap();
    assert!(newer.header && matches!(Log::read(newer.bytes), Err(LogError::Newer { found: 2, .. })));
    let metadata = header().metadata();
    let ours: Vec<(&str, &str)> =
        metadata.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
    assert!(Log::read(with_metadata(&[&ours])).is_ok());
    assert!(matches!(named(&[&ours, &ours]), LogError::SeveralRuns { runs: 2 }));
    assert!(matches!(named(&[&[("version", "1")]]), LogError::Damaged { .. }));
    assert!(matches!(named(&[&[("schema", "1")]]), LogError::Damaged { .. }));
    let run = small(0.1);
    for first in [&run[..], &run[..run.len() / 2]] {
        let two = [first, &run].concat();
        assert!(matches!(Log::read(two.clone()), Err(LogError::SeveralRuns { runs: 2 })));
        assert!(matches!(recover(&two), Err(LogError::SeveralRuns { runs: 2 })));
    }
    // The first one is cut off, and a bit of the second one's first byte is wrong.
    let mut two = [&run[..run.len() / 2], &run].concat();
    two[run.len() / 2] ^= 1;
    assert!(matches!(recover(&two), Err(LogError::SeveralRuns { runs: 2 })));
}

/// Cuts a file at many lengths, or at all of them.
fn cut_off(thorough: bool) {
    let bytes = small(1.3);
    // Ends of the chunk records.
    let records = super::reader::records(&bytes, mcap::MAGIC.len()).map_while(|record| record);
    let ends: Vec<usize> = records
        .filter(|record| record.opcode == mcap::records::op::CHUNK)
        .map(|record| record.end())
        .collect();
    assert!(ends.len() >= 2, "{ends:?}");
    // All cuts near the ends of chunks and of the file, and some of the others.
    let near = |cut: usize| ends.iter().chain([&0, &bytes.len()]).any(|end| end.abs_diff(cut) < 60);
    for cut in (0..bytes.len()).filter(|&cut| cut % 61 == 0 || near(cut) || thorough) {
        let part = &bytes[..cut];
        assert!(Log::read(part.to_vec()).is_err(), "cut at {cut}");
        let complete = ends.iter().filter(|&&end| end <= cut).count();
        match recover(part) {
            Ok(saved) => {
                assert_eq!(saved.chunks, complete, "cut at {cut}");
                let log = Log::read(saved.bytes);
                assert!(complete == 0 || log.is_ok(), "cut at {cut}: {log:?}");
            }
            Err(_) => assert_eq!(complete, 0, "cut at {cut}"),
        }
    }
    let whole = recover(&bytes).unwrap();
    assert!(whole.bytes == bytes && whole.lost == 0);
}

#[test]
fn every_cut_gives_back_all_complete_chunks() {
    cut_off(false);
}

/// What a robot read and commanded.
fn entries(log: &Log) -> Vec<Entry> {
    log.entries(0).collect()
}

/// Whether a recording holds nothing but what another one holds, in its order.
fn is_part_of(log: &Log, whole: &[Entry]) -> bool {
    let mut whole = whole.iter();
    entries(log).iter().all(|entry| whole.any(|other| other == entry))
}

/// Flips a bit of some bytes, or every bit, and counts the parts that are lost.
fn lose_parts(thorough: bool) {
    let attachments = ["a", "b"].map(|name| Attachment {
        name: name.into(),
        media_type: "text/plain".into(),
        data: name.repeat(50).into(),
    });
    let header = Header { attachments: attachments.to_vec(), ..header() };
    let writer = LogWriter::new(Vec::new(), &header).unwrap();
    let simulation = Simulation::new(&scene(), SimOptions::with_noise(1.0, 7)).unwrap();
    blind_tour(&mut writer.recorder(simulation.robot(0).unwrap(), 0), 1.3).unwrap();
    let bytes = writer.finish().unwrap();

    let parts = |recovery: &Recovery| {
        let records = super::reader::records(&recovery.bytes, mcap::MAGIC.len()).map_while(|record| record);
        let attached = records.filter(|record| record.opcode == mcap::records::op::ATTACHMENT).count();
        recovery.chunks + attached + usize::from(recovery.header)
    };
    let all_entries = entries(&Log::read(bytes.clone()).unwrap());
    let whole = recover(&bytes).unwrap();
    assert!(whole.chunks >= 2 && parts(&whole) == whole.chunks + 3);
    let start = bytes.len().min(700);
    let some = (0..start).chain((start..bytes.len()).step_by(307)).map(|place| (place, place % 8));
    let all = (0..bytes.len()).flat_map(|place| (0..8).map(move |bit| (place, bit)));
    let flips: Vec<(usize, usize)> = if thorough { all.collect() } else { some.collect() };
    for (place, bit) in flips {
        let mut broken = bytes.clone();
        broken[place] ^= 1 << bit;
        let saved = recover(&broken).unwrap();
        let lost = parts(&whole) - parts(&saved);
        assert!(lost <= 1, "byte {place}: {lost} of {} parts", parts(&whole));
        match Log::read(saved.bytes) {
            Ok(log) => {
                assert!(saved.header && is_part_of(&log, &all_entries), "byte {place}");
                assert_eq!(log.lacks_attachments(), log.header().attachments != attachments, "byte {place}");
                let ours = Header { attachments: Vec::new(), ..log.header().clone() };
                assert_eq!(ours, Header { attachments: Vec::new(), ..header.clone() }, "byte {place}");
            }
            Err(error) => {
                assert!(matches!(error, LogError::NoHeader) && !saved.header, "byte {place}: {error}");
            }
        }
    }
}

/// The channels are declared in the first chunk and in the summary, which the byte moves.
#[test]
fn a_byte_added_to_the_first_chunk_costs_that_chunk() {
    let writer = LogWriter::new(Vec::new(), &Header::new("tour", [""; 0])).unwrap();
    let simulation = Simulation::new(&scene(), SimOptions::with_noise(1.0, 7)).unwrap();
    blind_tour(&mut writer.recorder(simulation.robot(0).unwrap(), 0), 1.3).unwrap();
    let mut bytes = writer.finish().unwrap();
    let whole = recover(&bytes).unwrap().chunks;
    let chunk = super::reader::records(&bytes, mcap::MAGIC.len())
        .flatten()
        .find(|record| record.opcode == mcap::records::op::CHUNK)
        .unwrap();
    bytes.insert(chunk.start + chunk.body.len() / 2, 0);
    let saved = recover(&bytes).unwrap();
    assert!(whole >= 2 && saved.chunks == whole - 1, "{} of {whole}", saved.chunks);
}

#[test]
fn a_flipped_bit_costs_one_part_at_most() {
    lose_parts(false);
}

/// Flips some bits of a file, or every bit, a single one each time.
fn flip_bits(thorough: bool) {
    let bytes = small(0.2);
    let log = Log::read(bytes.clone()).unwrap();
    let all_entries = entries(&log);
    let mut found_out = 0;
    let bits = (0..8 * bytes.len()).filter(|bit| bit % 401 == 0 || thorough);
    let mut flips = 0;
    for bit in bits {
        let place = bit / 8;
        flips += 1;
        let mut broken = bytes.clone();
        broken[place] ^= 1 << (bit % 8);
        match Log::read(broken.clone()) {
            Err(_) => found_out += 1,
            Ok(other) => {
                assert_eq!(
                    (other.header(), entries(&other)),
                    (log.header(), all_entries.clone()),
                    "byte {place}"
                );
            }
        }
        if let Ok(log) = recover(&broken).and_then(|saved| Log::read(saved.bytes)) {
            assert!(is_part_of(&log, &all_entries), "byte {place}");
        }
    }
    println!("{found_out} of {flips} flipped bits are found out, the others are harmless");
    assert!(found_out > flips * 99 / 100, "{found_out} of {flips}");
}

#[test]
fn every_flipped_bit_is_found_out_or_harmless() {
    flip_bits(false);
}

/// Every bit and every length, within half a gigabyte once the tests are built: `ulimit -v 500000` before the
/// command, and `--test-threads 1` after it.
mod campaigns {
    #[test]
    #[ignore = "half a minute: cargo test --all-features --lib damage::campaigns -- --ignored"]
    fn every_length_gives_back_all_complete_chunks() {
        super::cut_off(true);
    }

    #[test]
    #[ignore = "half a minute: cargo test --all-features --lib damage::campaigns -- --ignored"]
    fn every_bit_costs_one_part_at_most() {
        super::lose_parts(true);
    }

    #[test]
    #[ignore = "half a minute: cargo test --all-features --lib damage::campaigns -- --ignored"]
    fn every_bit_is_found_out_or_harmless() {
        super::flip_bits(true);
    }
}

/// The first length in a file, that of the profile's name, once said 2 GiB to be asked for.
#[test]
fn a_length_beyond_its_record_is_damage() {
    let mut bytes = small(0.2);
    bytes[20] ^= 0x80;
    let first = super::reader::record_at(&bytes, mcap::MAGIC.len()).unwrap();
    assert!(first.parse().unwrap_err().to_string().contains("at byte 8 is too short"));
    let saved = recover(&bytes).unwrap();
    assert!(saved.header && Log::read(saved.bytes).is_ok());
}

/// A file with compressed chunks, each of some equal messages.
#[cfg(feature = "zstd")]
fn monotonous(chunks: u32, messages: u32, nothing: &[u8]) -> Vec<u8> {
    let metadata = header().metadata();
    let options = mcap::WriteOptions::new().compression(Some(mcap::Compression::Zstd)).chunk_size(None);
    let mut file = options.create(io::Cursor::new(Vec::new())).unwrap();
    file.write_metadata(&mcap::records::Metadata { name: "roverlab".into(), metadata }).unwrap();
    let schema = file.add_schema("nothing", "protobuf", &[]).unwrap();
    let channel_id = file.add_channel(schema, "/nothing", "protobuf", &BTreeMap::new()).unwrap();
    for sequence in 0..chunks {
        let times = mcap::records::MessageHeader { channel_id, sequence, log_time: 0, publish_time: 0 };
        for _ in 0..messages {
            file.write_to_known_channel(&times, nothing).unwrap();
        }
        file.flush().unwrap();
    }
    file.finish().unwrap();
    file.into_inner().into_inner()
}

/// A small file may hold gigabytes of nothing.
#[cfg(feature = "zstd")]
#[test]
fn a_file_that_unpacks_to_far_more_than_files_do_is_refused() {
    let bytes = monotonous(20, 1, &vec![0; 20 << 20]);
    assert!(bytes.len() < 60_000, "{}", bytes.len());
    let error = Log::read(bytes.clone()).unwrap_err().to_string();
    assert!(error.contains("uncompressed bytes; expected at most"), "{error}");
    let saved = recover(&bytes).unwrap();
    assert!(saved.header && (1..20).contains(&saved.chunks), "{}", saved.chunks);
}

/// Nor does it hold more messages than bytes. (The indices of messages, which have bytes for each, are left
/// out.)
#[cfg(feature = "zstd")]
#[test]
fn a_file_of_far_more_messages_than_bytes_is_refused() {
    let whole = monotonous(2, 200_000, &[]);
    let is_index = |record: &super::reader::Framed<'_>| record.opcode == mcap::records::op::MESSAGE_INDEX;
    let kept = super::reader::records(&whole, mcap::MAGIC.len()).flatten().filter(|record| !is_index(record));
    let kept: Vec<&[u8]> = kept.map(|record| &whole[record.start..record.end()]).collect();
    let bytes = [mcap::MAGIC, &kept.concat()].concat();
    assert!(bytes.len() < 10_000, "{}", bytes.len());
    let saved = recover(&bytes).unwrap();
    assert!(saved.header && saved.messages == 0 && saved.lost > 0, "{saved:?}");
    assert!(recover(&whole).unwrap().messages == 400_000);
}

proptest! {
    #![proptest_config(crate::testing::cases(64))]

    #[test]
    fn no_bytes_break_the_reader(mut tail: Vec<u8>, at in 0..4000_usize, length in 0..4000_usize) {
        let bytes = small(0.1);
        let (start, end) = (at.min(bytes.len()), (at + length).min(bytes.len()));
        let mut broken = bytes[..start].to_vec();
        broken.append(&mut tail);
        broken.extend_from_slice(&bytes[end..]);
        let _ = Log::read(broken.clone());
        if let Ok(saved) = recover(&broken) {
            prop_assert!(saved.lost <= broken.len());
        }
    }
}
