/// Step in which places are tried (m).
const STEP: f64 = 0.005;

/// Middle of the free spot in a gap between boxes. Spots of a width are beside each other (m), and every box
/// stands inside one of them; of the places at which boxes cross their lines least, it is the middle one.
pub(super) fn spot_middle(boxes: &[(f64, f64)], (from, to): (f64, f64), width: f64) -> f64 {
    let count = ((to - width - from) / STEP).max(0.0) as usize;
    let crossed = |begin: f64| boxes.iter().map(|it| crosses(*it, begin, width)).sum::<f64>();
    let places: Vec<(f64, f64)> =
        (0..=count).map(|step| from + STEP * step as f64).map(|begin| (begin, crossed(begin))).collect();
    let least = places.iter().map(|place| place.1).fold(f64::INFINITY, f64::min);
    let mut best = places.iter().filter(|place| place.1 < least + 0.5 * STEP).map(|place| place.0);
    let first = best.next().unwrap_or(from);
    if count == 0 { 0.5 * (from + to) } else { 0.5 * (first + best.next_back().unwrap_or(first) + width) }
}

/// How far a box crosses the lines of spots that begin at a place (m), for the spot that suits it best.
fn crosses((near, far): (f64, f64), begin: f64, width: f64) -> f64 {
    let spot = ((0.5 * (near + far) - begin) / width).floor();
    let line = begin + width * spot;
    (line - near).max(0.0) + (far - line - width).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(128))]
        #[test]
        fn spots_are_found_by_the_boxes_in_their_neighbours(
            begin in 2.0..3.0f64, free in 1..4_usize,
            boxes in prop::array::uniform5((0.16..0.28f64, 0.0..1.0f64)),
        ) {
            let spot = |index: usize| begin + 0.35 * index as f64;
            let place = |index: usize| {
                let (long, share) = boxes[index];
                let near = spot(index) + share * (0.35 - long);
                (near, near + long)
            };
            let boxes: Vec<(f64, f64)> = (0..5).filter(|index| *index != free).map(place).collect();
            let gap = (boxes[free - 1].1, boxes[free].0);
            let middle = spot_middle(&boxes, gap, 0.35);
            prop_assert!((middle - spot(free) - 0.175).abs() < 0.10, "{}", middle - spot(free));
            let simple = 0.5 * (gap.0 + gap.1);
            prop_assert!((gap.0..gap.1 - 0.34).contains(&(middle - 0.175)), "{middle} {simple}");
        }
    }

    #[test]
    fn a_gap_of_one_spot_is_the_spot() {
        assert_eq!(spot_middle(&[], (1.0, 1.35), 0.35), 1.175);
        assert_eq!(spot_middle(&[], (1.0, 1.3), 0.35), 1.15);
    }
}
