use super::statistics::GenerationStatistics;
use crate::geometry::Point;
use crate::picture::{Picture, Style};
use crate::world::{Colour, World};

/// Width of a panel (m on the sheet).
const WIDTH: f64 = 2.0;
/// Height of a panel (m on the sheet).
const HEIGHT: f64 = 0.5;
/// Margin around the panels (m on the sheet).
const MARGIN: f64 = 0.2;
/// Margin on their left, for the scale (m on the sheet).
const LEFT: f64 = 0.5;

/// Plots a run: best, mean and worst fitness per generation, and below them the diversity.
///
/// ```
/// use roverlab::evolve::{Evolution, Genetic, Recipe, Serial, StopRules, Trial, chart};
/// let ones = |genome: &Vec<u8>, _: Trial| Ok(f64::from(genome[0].count_ones()));
/// let mut evolution = Genetic::new(vec![vec![0_u8]; 20], Recipe::book(6), 1)?;
/// evolution.run(&mut Serial::new(ones), &StopRules::generations(10), |_| Ok(()))?;
/// let picture = chart(evolution.history()).to_svg();
/// assert!(["best", "mean", "worst", "diversity"].iter().all(|curve| picture.contains(curve)));
/// # Ok::<(), roverlab::io::Error>(())
/// ```
pub fn chart(history: &[GenerationStatistics]) -> Picture {
    let sheet = World::empty(LEFT + WIDTH + MARGIN, 2.0 * HEIGHT + 3.0 * MARGIN);
    let mut picture = Picture::new(&sheet);
    picture.title("Evolution, generation by generation").without_scale();
    let fitness: [Curve<'_>; 3] = [
        ("best", Colour::from_hex(0x001f_6fb4), |row| row.best),
        ("mean", Colour::from_hex(0x00c0_7a1b), |row| row.mean),
        ("worst", Colour::from_hex(0x0099_9999), |row| row.worst),
    ];
    let lower = Panel { history, bottom: MARGIN, height: HEIGHT };
    let upper = Panel { history, bottom: 2.0 * MARGIN + HEIGHT, height: HEIGHT };
    lower.draw(&mut picture, &[("diversity", Colour::from_hex(0x002b_8a3e), |row| row.diversity)], 0.0);
    // The scale follows the best fitness, so that one failed individual does not flatten the curves.
    let bests = || history.iter().map(|row| row.best);
    let (first, last) = (bests().fold(f64::INFINITY, f64::min), bests().fold(f64::NEG_INFINITY, f64::max));
    upper.draw(&mut picture, &fitness, first - (last - first).max(0.05 * last.abs()));
    picture
}

/// Name and colour of a curve, and the value it shows.
type Curve<'a> = (&'a str, Colour, fn(&GenerationStatistics) -> f64);

/// A panel of curves on a common scale.
struct Panel<'a> {
    history: &'a [GenerationStatistics],
    bottom: f64,
    height: f64,
}

impl Panel<'_> {
    fn draw(&self, picture: &mut Picture, curves: &[Curve<'_>], least: f64) {
        let values = || curves.iter().flat_map(|(_, _, value)| self.history.iter().map(value));
        let least = if least.is_finite() { least } else { 0.0 };
        let most = values().fold(f64::NEG_INFINITY, f64::max).max(least + f64::MIN_POSITIVE);
        let last = self.history.len().saturating_sub(1).max(1) as f64;
        let at = |generation: f64, value: f64| {
            let up = ((value - least) / (most - least)).clamp(0.0, 1.0);
            Point::new(LEFT + WIDTH * generation / last, self.bottom + self.height * up)
        };
        picture.line([at(0.0, most), at(0.0, least), at(last, least)], Style::aid());
        for value in [least, most] {
            let place = at(0.0, value);
            picture.text(Point::new(place.x - 0.5 * LEFT, place.y), format!("{value:.3}"));
        }
        picture.text(Point::new(LEFT + WIDTH, self.bottom - 0.4 * MARGIN), format!("{last}"));
        for &(name, colour, value) in curves {
            let points = (0..).zip(self.history).map(|(i, row)| at(f64::from(i), value(row)));
            picture.line(points, Style::new(colour).width(2.0).labelled(name));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(generation: u64) -> GenerationStatistics {
        let best = generation as f64;
        GenerationStatistics {
            generation,
            evaluations: 1,
            best,
            mean: 0.5 * best,
            worst: -1.0,
            diversity: 2.0,
        }
    }

    #[test]
    fn all_curves_are_named_whatever_the_length() {
        for length in [0, 1, 2, 50] {
            let history: Vec<_> = (0..length).map(row).collect();
            let svg = chart(&history).to_svg();
            let named = ["best", "mean", "worst", "diversity"].iter().all(|name| svg.contains(name));
            // The legend lists what is drawn; a line takes two generations.
            assert_eq!(named, length > 1, "{length}");
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{length}");
            assert!(!svg.contains(" m<"), "a chart has no scale in metres: {svg}");
        }
    }
}
