//! Recordings with compressed chunks.

use super::*;

/// A run recorded with compressed chunks.
#[cfg(any(feature = "lz4", feature = "zstd"))]
fn packed(compression: Compression) -> Vec<u8> {
    let simulation = Simulation::new(&scene(), SimOptions::with_noise(1.0, 7)).unwrap();
    let writer = LogWriter::new(Vec::new(), &Header { compression, ..header() }).unwrap();
    let mut robot = writer.recorder(simulation.robot(0).unwrap(), 0);
    tour(&mut robot, 2.5).unwrap();
    drop(robot);
    writer.finish().unwrap()
}

#[cfg(any(feature = "lz4", feature = "zstd"))]
#[test]
fn packed_recordings_are_as_good_as_others() {
    let plain = packed(Compression::None);
    let entries = |log: &Log| log.entries(0).collect::<Vec<_>>();
    let expected = entries(&Log::read(plain.clone()).unwrap());
    for compression in [
        #[cfg(feature = "lz4")]
        Compression::Lz4,
        #[cfg(feature = "zstd")]
        Compression::Zstd,
    ] {
        let bytes = packed(compression);
        assert!(bytes == packed(compression) && bytes.len() < plain.len() * 3 / 4, "{}", bytes.len());
        let log = Log::read(bytes.clone()).unwrap();
        assert_eq!((log.header().compression, entries(&log)), (compression, expected.clone()));
        let writer = LogWriter::new(Vec::new(), log.header()).unwrap();
        let mut robot = writer.recorder(Replay::new(&log, 0).unwrap(), 0);
        tour(&mut robot, 2.5).unwrap();
        drop(robot);
        assert!(writer.finish().unwrap() == bytes);
        let whole = recover(&bytes).unwrap();
        assert!(whole.bytes == bytes && whole.lost == 0);
        for cut in (0..bytes.len()).step_by(97) {
            assert!(Log::read(bytes[..cut].to_vec()).is_err());
            if let Ok(saved) = recover(&bytes[..cut]) {
                assert!(saved.chunks < whole.chunks || cut > bytes.len() / 2);
            }
        }
        for place in (0..bytes.len()).step_by(29) {
            let mut broken = bytes.clone();
            broken[place] ^= 1 << (place % 8);
            if let Ok(other) = Log::read(broken.clone()) {
                assert_eq!(entries(&other), expected, "byte {place}");
            }
            let _ = recover(&broken);
        }
    }
}

#[cfg(not(feature = "zstd"))]
#[test]
fn a_build_that_cannot_pack_says_so() {
    let header = Header { compression: Compression::Zstd, ..header() };
    let error = LogWriter::new(Vec::new(), &header).unwrap_err();
    assert!(error.kind() == io::ErrorKind::Unsupported && error.to_string().contains("`zstd`"), "{error}");
}
