use super::*;
use crate::geometry::Vector;
use crate::race::{GeneratedTrack, TrackOptions, generate, parse_eufs, write_eufs};
use crate::random::Stream;
use std::f64::consts::{PI, TAU};

/// Reads a track from a file from which rows are removed and to which others are added. Returns the
/// length found and the true one.
fn spoiled(seed: u64, missing: f64, added: f64) -> (Result<f64, LineError>, f64) {
    let GeneratedTrack { track, corridor } = generate(seed, &TrackOptions::drawn(seed)).unwrap();
    let mut random = Stream::new(seed).child("spoiled", 0);
    let written = write_eufs(&track);
    let is_kept = |line: &&str| {
        let is_cone = !line.starts_with("tag") && !line.starts_with("car_start");
        !(is_cone && random.chance(missing))
    };
    let mut text: String = written.lines().filter(is_kept).flat_map(|line| [line, "\n"]).collect();
    let mut random = Stream::new(seed).child("added", 0);
    for _ in 0..(added * track.cones.len() as f64) as usize {
        let station = corridor.stations()[random.below(corridor.stations().len())];
        let colour = ["unknown", "blue", "yellow"][random.below(3)];
        let beyond = random.between(0.8, 3.0);
        let offset = if random.chance(0.5) { station.left + beyond } else { -station.right - beyond };
        let place = station.aside(offset);
        text.extend([format!("{colour},{},{},0,0,0,0\n", place.x, place.y)]);
    }
    let read = parse_eufs(&text, "spoiled.csv").unwrap();
    let found = CentreLine::round_track(&read.cones, read.start_pose().unwrap());
    (found.map(|line| line.corridor.length()), corridor.length())
}

/// Removes cones of a colour in a row, from one on, from a generated track. Returns the length found and
/// the true one.
fn one_sided(
    whole: &GeneratedTrack,
    colour: ConeColour,
    from: usize,
    count: usize,
) -> (Result<f64, LineError>, f64) {
    let (all, mut at) = (whole.track.of(colour).count(), 0);
    let mut cones = whole.track.cones.clone();
    cones.retain(|cone| {
        let own = cone.colour == colour;
        at += usize::from(own);
        !own || (at - 1 + all - from) % all >= count
    });
    let found = CentreLine::round_track(&cones, whole.track.start_pose().unwrap());
    (found.map(|line| line.corridor.length()), whole.corridor.length())
}

/// Without ten cones of its right edge in a bend, a loop along cones of its left one is 3.1 % too short.
#[test]
fn no_edge_of_a_loop_is_made_of_cones_of_the_other() {
    let whole = generate(39, &TrackOptions::drawn(39)).unwrap();
    let (found, truth) = one_sided(&whole, ConeColour::Yellow, 30, 10);
    let wrong = found.is_ok_and(|length| (length / truth - 1.0).abs() > 0.03);
    assert!(!wrong, "a loop of another length than {truth} m");
}

/// Number of loops read from spoiled tracks, number of tracks, and descriptions of wrong loops.
fn read(seeds: std::ops::Range<u64>) -> (usize, usize, Vec<String>) {
    let (mut read, mut all, mut wrong) = (0, 0, Vec::new());
    let mut refusals = BTreeMap::<String, usize>::new();
    for seed in seeds {
        for (missing, added) in
            [(0.0, 0.0), (0.05, 0.0), (0.1, 0.0), (0.2, 0.0), (0.0, 0.1), (0.0, 0.2), (0.1, 0.1)]
        {
            let (found, truth) = spoiled(seed, missing, added);
            all += 1;
            match found {
                Ok(length) if (length / truth - 1.0).abs() > 0.03 => {
                    wrong.push(format!("{seed}: {missing}, {added}: {length} m of {truth}"));
                }
                Ok(_) => read += 1,
                Err(error) => *refusals.entry(format!("{missing}, {added}: {error}")).or_default() += 1,
            }
        }
    }
    println!("{read} of {all} read; {refusals:#?}");
    (read, all, wrong)
}

#[test]
fn a_track_without_some_cones_is_read_right_or_refused() {
    let (read, all, wrong) = read(0..12);
    assert!(wrong.is_empty() && 5 * read > 2 * all, "{read} of {all}: {wrong:#?}");
}

fn of_file(file: &str) -> Result<f64, LineError> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/cones");
    let text = std::fs::read_to_string(format!("{folder}/{file}")).unwrap();
    let track = parse_eufs(&text, file).unwrap();
    let found = CentreLine::round_track(&track.cones, track.start_pose().unwrap());
    found.map(|line| line.corridor.length())
}

/// A bend without its inner cones, where the loop's edge would fold and cut 4 % off, and a straight on
/// which three cones have the other edge's colour: the first loop there is 28 % too long, and its edges
/// cross.
#[test]
fn loops_with_folded_edges_are_refused() {
    let error = of_file("blind_bend.csv").unwrap_err().to_string();
    assert!(error.contains("turns back"), "{error}");
    let length = of_file("swapped_colours.csv").unwrap();
    assert!((length / 123.3 - 1.0).abs() < 0.03, "{length}");
}

/// The length found of a circle of 20 m, of which a share of the cones is missing, and which has another
/// share of false ones.
fn circle(seed: u64, missing: f64, added: f64) -> Result<f64, LineError> {
    let mut random = Stream::new(seed).child("circle", 0);
    let mut cones = Vec::new();
    for (count, radius, colour) in [(9, 1.65, ConeColour::Blue), (18, 4.65, ConeColour::Yellow)] {
        for k in 0..count {
            let place = Point::origin() + direction(TAU * f64::from(k) / f64::from(count)) * radius;
            if !random.chance(missing) {
                cones.push(Cone::new(place, colour));
            }
            let aside = Vector::new(random.between(-3.0, 3.0), random.between(-3.0, 3.0));
            if random.chance(added) {
                cones.push(Cone::new(place + aside, colour));
            }
        }
    }
    CentreLine::round_track(&cones, Pose::new(0.0, -3.15, 0.0)).map(|line| line.corridor.length())
}

#[test]
fn short_loops_are_as_long_as_their_edges() {
    let whole = circle(0, 0.0, 0.0).unwrap();
    let found = (0..800).filter_map(|seed| circle(seed, 0.1, 0.15).ok());
    let errors: Vec<f64> = found.map(|length| length / whole - 1.0).collect();
    let wrong = errors.iter().filter(|error| error.abs() > 0.03).count();
    println!("{} read, {wrong} wrong", errors.len());
    assert!(errors.len() > 20 && wrong == 0, "{errors:?}");
}

/// The length found of two straights of 16 m and two bends, relative to the true one. Cones of an edge
/// are `spacing` metres apart.
fn stadium(radius: f64, spacing: f64) -> Result<f64, LineError> {
    let mut cones = Vec::new();
    for (radius, colour) in [(radius - 1.75, ConeColour::Blue), (radius + 1.75, ConeColour::Yellow)] {
        let half = 16.0 + PI * radius;
        let count = (half / spacing).round();
        for k in 0..2 * count as usize {
            let way = (k as f64 * half / count) % half;
            let place = if way < 16.0 {
                Point::new(way - 8.0, -radius)
            } else {
                Point::new(8.0, 0.0) + direction((way - 16.0) / radius - 0.5 * PI) * radius
            };
            let side = if (k as f64) < count { 1.0 } else { -1.0 };
            cones.push(Cone::new(place * side, colour));
        }
    }
    let line = CentreLine::round_track(&cones, Pose::new(0.0, -radius, 0.0))?;
    Ok(line.corridor.length() / (32.0 + TAU * radius))
}

/// Chords between few cones of a tight bend cut up to 4 % off.
#[test]
fn loops_do_not_cut_bends_of_few_cones() {
    for (radius, spacing) in [(5.0, 5.0), (5.0, 3.0), (9.0, 5.0)] {
        let length = stadium(radius, spacing).unwrap();
        assert!((length - 1.0).abs() < 0.015, "{radius} m: {length}");
    }
}

/// Cones without a colour count where most are such, but not where a few are beside a track.
#[test]
fn a_loop_of_colourless_cones_passes_nearly_all() {
    let circle =
        |radius: f64| (0..18).map(move |k| Point::origin() + direction(TAU * f64::from(k) / 18.0) * radius);
    let ring = Corridor::closed(&circle(10.0).map(|at| (at, 1.5, 1.5)).collect::<Vec<_>>()).unwrap();
    let edges = |left: ConeColour, right: ConeColour| {
        let of = |radius, colour| circle(radius).map(move |at| Cone::new(at, colour));
        of(8.5, left).chain(of(11.5, right)).collect::<Vec<_>>()
    };
    let elsewhere: Vec<Cone> = circle(30.0).map(Cone::unknown).collect();
    let colourless = edges(ConeColour::Unknown, ConeColour::Unknown);
    assert_eq!(check(&ring, &colourless), Ok(()));
    let all = [&colourless[..], &elsewhere].concat();
    assert_eq!(check(&ring, &all), Err(LineError::Passes { passed: 36, all: 54 }));
    let coloured = [&edges(ConeColour::Blue, ConeColour::Yellow)[..], &elsewhere].concat();
    assert_eq!(check(&ring, &coloured), Ok(()));
}

#[test]
fn a_start_against_the_colours_is_refused() {
    for seed in 0..5 {
        let track = generate(seed, &TrackOptions::drawn(seed)).unwrap().track;
        let start = track.start_pose().unwrap();
        let turned = Pose::new(start.x, start.y, start.heading + PI);
        assert_eq!(CentreLine::round_track(&track.cones, turned), Err(LineError::Against), "{seed}");
    }
}

mod campaigns {
    use super::*;

    #[test]
    #[ignore = "takes a minute: cargo test --release --all-features --lib round -- --ignored"]
    fn three_hundred_spoiled_tracks_are_read_right_or_refused() {
        let (read, all, wrong) = read(100..143);
        assert!(wrong.is_empty() && 5 * read > 2 * all, "{read} of {all}: {wrong:#?}");
    }

    #[test]
    #[ignore = "takes a minute: cargo test --release --all-features --lib round -- --ignored"]
    fn tracks_without_cones_of_one_side_in_a_row_are_read_right_or_refused() {
        let (mut read, mut all, mut wrong) = (0, 0, Vec::new());
        for seed in 0..40 {
            let whole = generate(seed, &TrackOptions::drawn(seed)).unwrap();
            for colour in [ConeColour::Blue, ConeColour::Yellow] {
                let places = (0..whole.track.of(colour).count()).step_by(3);
                for (from, count) in places.flat_map(|k| [3, 4, 6, 8, 10, 12].map(|n| (k, n))) {
                    let (found, truth) = one_sided(&whole, colour, from, count);
                    all += 1;
                    match found {
                        Ok(length) if (length / truth - 1.0).abs() > 0.03 => {
                            wrong.push(format!("{seed}: {colour:?}, {count} from {from}: {length}, {truth}"));
                        }
                        found => read += usize::from(found.is_ok()),
                    }
                }
            }
        }
        println!("{read} of {all} read");
        assert!(wrong.is_empty() && 4 * read > 3 * all, "{read} of {all}: {wrong:#?}");
    }
}

#[test]
fn what_is_wrong_is_said() {
    let lane = |i: u32| {
        let place = |y: f64| Point::new(4.0 * f64::from(i), y);
        [Cone::new(place(1.5), ConeColour::Blue), Cone::new(place(-1.5), ConeColour::Yellow)]
    };
    let open: Vec<Cone> = (0..10).flat_map(lane).collect();
    let error = CentreLine::round_track(&open, Pose::default()).unwrap_err();
    assert!(error.to_string().contains("does not close"), "{error}");
}
