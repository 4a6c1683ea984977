use crate::geometry::{Point, Segment};
use crate::world::Colour;

/// A closed two-lane road, seen from above.
#[derive(Debug)]
pub(super) struct Road {
    /// Road coordinates of each pixel, row by row from the far side; `None` beside the road.
    places: Vec<Option<Place>>,
    side: usize,
    /// Size of a pixel (m).
    pixel: f64,
}

#[derive(Debug, Clone, Copy)]
struct Place {
    /// Distance from the centre line (m).
    aside: f64,
    /// Distance along the centre line (m).
    along: f64,
}

/// Width of a lane (m).
const LANE: f64 = 0.200;
/// Width of a line (m).
const LINE: f64 = 0.012;
/// Length of a dash and of the gap after it (m).
const DASH: f64 = 0.120;
/// Colour of the model town's floor.
const ASPHALT: Colour = Colour::from_hex(0x2c_2c_2e);
/// Colour of the road markings.
const PAINT: Colour = Colour::from_hex(0xf4_f4_f4);

impl Road {
    /// The road around some corners on a square floor of `side` pixels, each `pixel` metres wide.
    pub(super) fn around(corners: &[Point], side: usize, pixel: f64) -> Self {
        let mut road = Self { places: vec![None; side * side], side, pixel };
        let line = smooth(corners);
        let mut along = 0.0;
        for (i, &a) in line.iter().enumerate() {
            let part = Segment::new(a, line[(i + 1) % line.len()]);
            road.lay(part, along);
            along += part.length();
        }
        road
    }

    /// Adds a straight part of the centre line.
    fn lay(&mut self, part: Segment, along: f64) {
        let pixel = self.pixel;
        let pixels = |low: f64, high: f64| {
            let (low, high) = ((low - LANE - LINE) / pixel, (high + LANE + LINE) / pixel);
            (low.max(0.0) as usize)..(high.max(0.0).ceil() as usize).min(self.side)
        };
        let (columns, rows) = (
            pixels(part.a.x.min(part.b.x), part.a.x.max(part.b.x)),
            pixels(part.a.y.min(part.b.y), part.a.y.max(part.b.y)),
        );
        let way = part.b - part.a;
        for up in rows {
            for column in columns.clone() {
                let point = Point::new((column as f64 + 0.5) * pixel, (up as f64 + 0.5) * pixel);
                let share = ((point - part.a).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
                let aside = (point - (part.a + way * share)).norm();
                let here = &mut self.places[(self.side - 1 - up) * self.side + column];
                if aside <= LANE + LINE && here.is_none_or(|before| aside < before.aside) {
                    *here = Some(Place { aside, along: along + share * way.norm() });
                }
            }
        }
    }

    /// Colour of a pixel, counted from the far left corner.
    pub(super) fn colour(&self, column: usize, row: usize) -> Colour {
        let Some(Place { aside, along }) = self.places[row * self.side + column] else { return ASPHALT };
        // Fraction of the pixel covered by a line at a distance.
        let covered = |distance: f64| ((0.5 * LINE - distance) / self.pixel + 0.5).clamp(0.0, 1.0);
        let dash = if along % (2.0 * DASH) < DASH { covered(aside) } else { 0.0 };
        let share = dash.max(covered((aside - LANE).abs()));
        let mixed = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
        Colour::new(
            mixed(ASPHALT.red, PAINT.red),
            mixed(ASPHALT.green, PAINT.green),
            mixed(ASPHALT.blue, PAINT.blue),
        )
    }
}

/// Smooths a closed line by four rounds of corner cutting (Chaikin's algorithm).
fn smooth(corners: &[Point]) -> Vec<Point> {
    let mut line = corners.to_vec();
    for _ in 0..4 {
        let next = line.iter().cycle().skip(1);
        line = line.iter().zip(next).flat_map(|(&a, &b)| [a + (b - a) * 0.25, a + (b - a) * 0.75]).collect();
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_lie_on_both_sides_of_the_lanes() {
        let corners = [(1.0, 1.0), (1.0, 3.0), (3.0, 3.0), (3.0, 1.0)].map(|(x, y)| Point::new(x, y));
        let road = Road::around(&corners, 800, 0.005);
        // Across the straight part on the left, half-way up.
        let row: Vec<usize> = (0..400).filter(|&column| road.colour(column, 400) != ASPHALT).collect();
        let near = |metres: f64| row.iter().any(|&column| (column as f64 * 0.005 - metres).abs() < 0.01);
        assert!(near(0.8) && near(1.2), "{row:?}");
        assert!(row.iter().all(|&column| (155..=245).contains(&column)), "{row:?}");
    }
}
