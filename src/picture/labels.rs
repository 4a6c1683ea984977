//! Places names beside their points without overlaps.

use super::frame::Pixel;
use super::text;
use crate::geometry::{Aabb, Vector};

/// Directions from a point to its name, best first: y points down.
const DIRECTIONS: [(f64, f64); 8] =
    [(0.8, -0.6), (0.8, 0.6), (-0.8, -0.6), (-0.8, 0.6), (1.0, 0.0), (-1.0, 0.0), (0.0, -1.0), (0.0, 1.0)];

/// Distance from symbol to name (pixels): near, or farther off with a lead line.
const GAPS: [f64; 4] = [2.0, 14.0, 28.0, 44.0];

/// Occupied space of the page.
#[derive(Debug, Clone)]
pub(super) struct Labels {
    page: Aabb,
    symbols: Vec<Aabb>,
    names: Vec<Aabb>,
    /// Lead lines from points to names that stand apart.
    leads: Vec<[Pixel; 2]>,
    /// Lines that names avoid if there is room elsewhere.
    lines: Vec<[Pixel; 2]>,
}

/// Position of a name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placed {
    /// Left end of its baseline.
    pub(super) start: Pixel,
    /// End of the lead line from its point, if it stands apart.
    pub(super) lead: Option<Pixel>,
}

impl Labels {
    pub(super) fn new(page: Aabb) -> Self {
        Self { page, symbols: Vec::new(), names: Vec::new(), leads: Vec::new(), lines: Vec::new() }
    }

    /// Keeps names off a box.
    pub(super) fn keep_off(&mut self, bounds: Aabb) {
        self.symbols.push(bounds);
    }

    /// Makes names avoid a line if there is room elsewhere.
    pub(super) fn avoid(&mut self, points: &[Pixel]) {
        self.lines.extend(points.windows(2).map(|ends| [ends[0], ends[1]]));
    }

    /// The best position for a name beside a symbol with a reach in pixels; `None` if all positions are
    /// taken.
    pub(super) fn place(&mut self, name: &str, at: Pixel, reach: f64) -> Option<Placed> {
        let extent = Vector::new(text::width(name, text::SIZE) + 2.0, text::SIZE + 1.0);
        let mut best: Option<(usize, Aabb, Option<Pixel>)> = None;
        // A text without a symbol is centred on its point if possible.
        let centred = Aabb { min: at - extent * 0.5, max: at + extent * 0.5 };
        if reach == 0.0 && self.is_free(&centred) {
            best = Some((0, centred, None));
        }
        for (ring, gap) in GAPS.into_iter().enumerate() {
            for towards in DIRECTIONS {
                let bounds = beside(at, towards, reach + gap, extent);
                let lead = (ring > 0).then(|| nearest(&bounds, at));
                if !self.is_free(&bounds) || lead.is_some_and(|end| self.hides_a_name([at, end])) {
                    continue;
                }
                let cost = 2 * ring + self.crossings(&bounds);
                if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
                    best = Some((cost, bounds, lead));
                }
            }
        }
        let (_, bounds, lead) = best?;
        self.names.push(bounds);
        self.leads.extend(lead.map(|end| [at, end]));
        Some(Placed { start: Pixel::new(bounds.min.x + 1.0, bounds.max.y - 3.0), lead })
    }

    fn is_free(&self, bounds: &Aabb) -> bool {
        self.page.contains(bounds.min)
            && self.page.contains(bounds.max)
            && !self.symbols.iter().chain(&self.names).any(|taken| overlap(taken, bounds))
            && !self.leads.iter().any(|lead| crosses(lead, bounds))
    }

    fn hides_a_name(&self, lead: [Pixel; 2]) -> bool {
        self.names.iter().any(|name| crosses(&lead, name))
    }

    /// Number of lines through a box, at most four: more make no difference.
    fn crossings(&self, bounds: &Aabb) -> usize {
        self.lines.iter().filter(|ends| crosses(ends, bounds)).take(4).count()
    }
}

/// The box of a name in a direction from its point.
fn beside(at: Pixel, (x, y): (f64, f64), distance: f64, extent: Vector) -> Aabb {
    let middle =
        at + Vector::new(x, y) * distance + Vector::new(side(x) * extent.x, side(y) * extent.y) * 0.5;
    Aabb { min: middle - extent * 0.5, max: middle + extent * 0.5 }
}

/// The point of a box nearest to a pixel.
fn nearest(bounds: &Aabb, at: Pixel) -> Pixel {
    at.sup(&bounds.min).inf(&bounds.max)
}

/// Sign of a number; zero for zero.
fn side(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

fn overlap(a: &Aabb, b: &Aabb) -> bool {
    a.min.x < b.max.x && b.min.x < a.max.x && a.min.y < b.max.y && b.min.y < a.max.y
}

/// Whether a line segment passes through a box: its parts inside each pair of sides overlap.
fn crosses([a, b]: &[Pixel; 2], bounds: &Aabb) -> bool {
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        let (from, along) = (a[axis], b[axis] - a[axis]);
        let (low, high) = (bounds.min[axis] - from, bounds.max[axis] - from);
        if along == 0.0 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
            continue;
        }
        let (first, second) = (low / along, high / along);
        enter = enter.max(first.min(second));
        leave = leave.min(first.max(second));
    }
    enter <= leave
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn page() -> Aabb {
        Aabb::new(Pixel::origin(), Pixel::new(300.0, 200.0))
    }

    fn pixel() -> impl Strategy<Value = Pixel> {
        (0.0..300.0f64, 0.0..200.0f64).prop_map(|(x, y)| Pixel::new(x, y))
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn names_neither_touch_nor_leave_the_page(points in prop::collection::vec(pixel(), 1..40)) {
            let mut labels = Labels::new(page());
            for (i, point) in points.iter().enumerate() {
                labels.place(&format!("H{i}"), *point, 7.0);
            }
            for (i, a) in labels.names.iter().enumerate() {
                prop_assert!(page().contains(a.min) && page().contains(a.max));
                prop_assert!(labels.names[i + 1..].iter().all(|b| !overlap(a, b)));
                // A lead line ends at the edge of its own name and crosses no other.
                let crossing = labels.leads.iter().filter(|lead| crosses(lead, &a.inflated(-0.5))).count();
                prop_assert_eq!(crossing, 0);
            }
        }

        #[test]
        fn a_line_crosses_a_box_where_one_of_its_points_is_inside(a in pixel(), b in pixel(), c in pixel(), d in pixel()) {
            let bounds = Aabb::new(c, d);
            let inside = (0..=400).any(|i| bounds.contains(a + (b - a) * (f64::from(i) / 400.0)));
            prop_assert!(!inside || crosses(&[a, b], &bounds));
            let away = bounds.inflated(2.0);
            let outside = (0..=400).all(|i| !away.contains(a + (b - a) * (f64::from(i) / 400.0)));
            prop_assert!(!outside || !crosses(&[a, b], &bounds));
        }
    }

    #[test]
    fn a_lonely_name_stands_upper_right_without_a_line() {
        let placed = Labels::new(page()).place("H1", Pixel::new(100.0, 100.0), 7.0).unwrap();
        assert!(placed.start.x > 100.0 && placed.start.y < 100.0 && placed.lead.is_none());
    }

    #[test]
    fn a_name_without_room_is_left_out() {
        let mut labels = Labels::new(page());
        labels.keep_off(page());
        assert_eq!(labels.place("H1", Pixel::new(100.0, 100.0), 7.0), None);
    }
}
