use proptest::prelude::*;

use crate::drive::cones::{GeneratedTrack, TrackOptions, generate};

/// Closed tracks of cones, legal by the rules of Formula Student: of all lengths, widths, distances of cones, and with up to
/// three hairpins.
pub fn cone_tracks() -> impl Strategy<Value = GeneratedTrack> {
    any::<u64>().prop_filter_map("options that no track meets", |seed| {
        generate(seed, &TrackOptions::drawn(seed)).ok()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::cones::{CentreLine, CentreLineParameters, RacingLineParameters, minimum_curvature};

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]
        /// What the whole plan is made of: the way closes, and the racing line bends less than the middle.
        #[test]
        fn every_track_can_be_planned(generated in cone_tracks()) {
            let GeneratedTrack { track, .. } = generated;
            let start = track.start.unwrap();
            let line = CentreLine::from_cones(&track.cones, start, &CentreLineParameters::default()).unwrap();
            prop_assert!(line.corridor.is_closed());
            let parameters = RacingLineParameters { margin: 0.9, ..RacingLineParameters::default() };
            let best = minimum_curvature(&line.corridor, &parameters).unwrap();
            let still = minimum_curvature(&line.corridor, &RacingLineParameters { iterations: 0, ..parameters }).unwrap();
            prop_assert!(best.bending_energy < 0.95 * still.bending_energy);
        }
    }
}
