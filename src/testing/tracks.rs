use proptest::prelude::*;

use crate::race::{GeneratedTrack, TrackOptions, generate};

/// Closed cone tracks, legal by the rules of Formula Student: various lengths, widths, cone distances, and up
/// to three hairpins.
///
/// ```
/// use proptest::prelude::*;
/// use proptest::test_runner::{Config, TestRunner};
/// use roverlab::testing::cone_tracks;
/// TestRunner::new(Config::with_cases(4)).run(&cone_tracks(), |generated| {
///     prop_assert!(generated.track.cones.len() > 40, "a lap has cones on both sides");
///     Ok(())
/// }).unwrap();
/// ```
pub fn cone_tracks() -> impl Strategy<Value = GeneratedTrack> {
    any::<u64>().prop_filter_map("options that no track meets", |seed| {
        generate(seed, &TrackOptions::drawn(seed)).ok()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::race::{CentreLine, CentreLineParameters, RacingLineParameters, minimum_curvature};

    proptest! {
        #![proptest_config(crate::testing::cases(12))]
        /// Tests the whole plan: the track closes, and the racing line bends less than the centre line.
        #[test]
        fn every_track_can_be_planned(generated in cone_tracks()) {
            prop_assert!(bending_left(&generated) < 1.0);
        }
    }

    /// Bending energy of the racing line relative to that of the centre line.
    fn bending_left(generated: &GeneratedTrack) -> f64 {
        let track = &generated.track;
        let start = track.start.unwrap();
        let line = CentreLine::from_cones(&track.cones, start, &CentreLineParameters::default()).unwrap();
        assert!(line.corridor.is_closed());
        let parameters = RacingLineParameters { margin: 0.9, ..RacingLineParameters::default() };
        let best = minimum_curvature(&line.corridor, &parameters).unwrap();
        let still = RacingLineParameters { iterations: 0, ..parameters };
        best.bending_energy / minimum_curvature(&line.corridor, &still).unwrap().bending_energy
    }

    #[test]
    fn a_narrow_track_of_wide_bends_leaves_little_to_gain() {
        // In a bend of radius r, a line d farther out has r / (r + d) of the curvature of the centre line.
        let seed = 8_368_310_778_412_755_768;
        let left = bending_left(&generate(seed, &TrackOptions::drawn(seed)).unwrap());
        assert!(left < 0.97, "{left}");
    }
}
