use crate::io::LidarScan;

/// A local extremum of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremum {
    /// Index of the beam.
    pub beam: usize,
    /// Direction relative to the scanner's mount (rad).
    pub angle: f64,
    /// Range, averaged over the window (m).
    pub range: f64,
    /// Peak or dip.
    pub kind: ExtremumKind,
}

/// Kind of extremum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExtremumKind {
    /// Farther away than its surroundings: the corner of a room.
    Peak,
    /// Nearer: the foot of a perpendicular on a wall, a convex corner, an object.
    Dip,
}

/// Peaks and dips of a scan, in beam order: the book's way to interpret a scan (section 4.1).
///
/// Ranges are averaged over `window` beams. A peak and the adjacent dip differ by more than `prominence` (m),
/// which suppresses noise. A beam without an echo counts as the scanner's maximum range. Unless the scan
/// covers a full turn, its first and last beam may be extrema.
///
/// ```
/// use roverlab::scan::{ExtremumKind, local_extrema};
/// use roverlab::io::LidarScan;
/// let ranges = (0..360).map(|i| 1.0 + 0.3 * f64::from(i % 90 - 45).abs() / 45.0).collect();
/// let scan = LidarScan { angle_min: 0.0, angle_increment: std::f64::consts::TAU / 360.0, range_max: 5.0, ranges,
///     ..LidarScan::default() };
/// let extrema = local_extrema(&scan, 5, 0.1);
/// assert_eq!(extrema.iter().filter(|extremum| extremum.kind == ExtremumKind::Peak).count(), 4);
/// assert_eq!(extrema.len(), 8);
/// ```
pub fn local_extrema(scan: &LidarScan, window: usize, prominence: f64) -> Vec<Extremum> {
    let beams = scan.ranges.len();
    if beams < 3 {
        return Vec::new();
    }
    let all_round = (scan.angle_increment.abs() * beams as f64 - std::f64::consts::TAU).abs() < 1e-6;
    let smooth = averaged(scan, window, all_round);
    // Begin at the nearest beam, which is certainly a dip.
    let first = (0..beams).min_by(|&a, &b| smooth[a].total_cmp(&smooth[b])).unwrap_or(0);
    let first = if all_round { first } else { 0 };
    let mut found: Vec<(usize, ExtremumKind)> = Vec::new();
    let (mut lowest, mut highest) = (first, first);
    let mut rising = None;
    let last = if all_round { beams } else { beams - 1 };
    for step in 0..=last {
        let beam = (first + step) % beams;
        if smooth[beam] > smooth[highest] {
            highest = beam;
        }
        if smooth[beam] < smooth[lowest] {
            lowest = beam;
        }
        if rising != Some(true) && smooth[beam] > smooth[lowest] + prominence {
            found.push((lowest, ExtremumKind::Dip));
            (rising, highest) = (Some(true), beam);
        } else if rising != Some(false) && smooth[beam] < smooth[highest] - prominence {
            found.push((highest, ExtremumKind::Peak));
            (rising, lowest) = (Some(false), beam);
        }
    }
    if !all_round {
        match rising {
            Some(true) => found.push((highest, ExtremumKind::Peak)),
            Some(false) => found.push((lowest, ExtremumKind::Dip)),
            None => {}
        }
    }
    found.sort_by_key(|&(beam, _)| beam);
    let extremum = |(beam, kind)| Extremum { beam, angle: scan.angle(beam), range: smooth[beam], kind };
    found.into_iter().map(extremum).collect()
}

/// Ranges averaged over a window around each beam.
fn averaged(scan: &LidarScan, window: usize, all_round: bool) -> Vec<f64> {
    let beams = scan.ranges.len() as isize;
    let half = (window.clamp(1, scan.ranges.len()) / 2) as isize;
    let range = |beam: isize| {
        let beam = if all_round { beam.rem_euclid(beams) } else { beam.clamp(0, beams - 1) };
        let range = scan.ranges[beam as usize];
        if range.is_finite() { range } else { scan.range_max }
    };
    (0..beams)
        .map(|beam| (beam - half..=beam + half).map(range).sum::<f64>() / (2 * half + 1) as f64)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn scan(ranges: Vec<f64>, field: f64) -> LidarScan {
        let angle_increment = field / ranges.len() as f64;
        LidarScan { angle_min: -0.5 * field, angle_increment, range_max: 9.0, ranges, ..LidarScan::default() }
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn peaks_and_dips_alternate(ranges in prop::collection::vec(0.1..5.0f64, 3..200), all_round: bool) {
            let extrema = local_extrema(&scan(ranges, if all_round { TAU } else { 3.0 }), 1, 0.3);
            for two in extrema.windows(2) {
                prop_assert!(two[0].kind != two[1].kind, "{:?}", extrema);
                let (low, high) = (two[0].range.min(two[1].range), two[0].range.max(two[1].range));
                prop_assert!(high - low > 0.3);
                let peak = if two[0].kind == ExtremumKind::Peak { two[0] } else { two[1] };
                prop_assert_eq!(peak.range, high);
            }
            if all_round {
                prop_assert!(extrema.len().is_multiple_of(2));
            }
        }

        #[test]
        fn turning_the_scanner_turns_the_extrema(shift in 0usize..360) {
            let ranges: Vec<f64> = (0..360).map(|i| 2.0 + f64::from(i * i % 97) / 97.0).collect();
            let turned: Vec<f64> = (0..360).map(|i| ranges[(i + shift) % 360]).collect();
            let [one, other] = [ranges, turned].map(|ranges| local_extrema(&scan(ranges, TAU), 3, 0.2));
            let mut beams: Vec<usize> = other.iter().map(|extremum| (extremum.beam + shift) % 360).collect();
            beams.sort_unstable();
            prop_assert_eq!(beams, one.iter().map(|extremum| extremum.beam).collect::<Vec<_>>());
        }
    }

    #[test]
    fn an_even_scan_has_none() {
        assert!(local_extrema(&scan(vec![1.0; 90], TAU), 5, 0.1).is_empty());
        assert!(local_extrema(&scan(vec![f64::INFINITY; 90], 3.0), 5, 0.1).is_empty());
        assert!(local_extrema(&scan(vec![1.0, 2.0], 3.0), 5, 0.1).is_empty());
    }
}
