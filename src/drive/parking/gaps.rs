/// Boxes beside a lane, as a distance sensor has passed them, and the gaps between them.
#[derive(Debug, Clone, Default)]
pub(super) struct Gaps {
    /// Beginning and end along the lane, and least distance from its centre (m).
    boxes: Vec<(f64, f64, f64)>,
    /// Where the sensor was last (m).
    last: f64,
}

/// Distance within which readings belong to one box (m): two lost readings at 0.5 m/s.
const JOINED: f64 = 0.06;

impl Gaps {
    /// Adds a reading at a position along the lane: the distance of a box from its centre, or none (m).
    pub(super) fn see(&mut self, along: f64, out: Option<f64>) {
        self.last = self.last.max(along);
        let Some(out) = out else { return };
        match self.boxes.last_mut() {
            Some((_, to, least)) if along < *to + JOINED => {
                *to = to.max(along);
                *least = least.min(out);
            }
            _ => self.boxes.push((along, along, out)),
        }
    }

    /// First gap of at least a length (m): between two boxes, or behind one with nothing for a distance (m).
    pub(super) fn find(&self, least: f64, open: f64) -> Option<(f64, f64)> {
        let ends = self.boxes.iter().skip(1).map(|it| it.0).chain([self.last]);
        let gaps = self.boxes.iter().zip(ends).enumerate();
        let is_last = |index: usize| index + 1 == self.boxes.len();
        gaps.map(|(index, (it, to))| (it.1, to, if is_last(index) { open } else { least }))
            .find(|(from, to, least)| to - from >= *least)
            .map(|(from, to, _)| (from, to))
    }

    /// Boxes: beginning, end, and distance from the lane's centre (m).
    pub(super) fn boxes(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        self.boxes.iter().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lost_readings_do_not_make_gaps_and_short_gaps_are_left() {
        let mut gaps = Gaps::default();
        for step in 0..300 {
            let along = 0.01 * f64::from(step);
            let is_box = [(0.2..0.5), (0.8..1.1), (1.8..2.1)].iter().any(|it| it.contains(&along));
            let is_lost = step % 7 == 0;
            gaps.see(along, (is_box && !is_lost).then_some(0.3));
        }
        assert_eq!(gaps.boxes().count(), 3);
        let (from, to) = gaps.find(0.6, 1.2).unwrap();
        assert!((from - 1.09).abs() < 0.02 && (to - 1.8).abs() < 0.02, "{from} {to}");
        assert_eq!(gaps.find(0.9, 1.2), None);
        assert!(gaps.find(0.9, 0.8).is_some(), "behind the last box");
    }
}
