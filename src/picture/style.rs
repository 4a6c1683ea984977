use super::colours::{CLOUD, GREEN, ODOMETRY, PALE_INK, SERIES};
use crate::world::Colour;

/// Style of a line, an area or a cloud of points, and its label in the legend.
///
/// ```
/// use roverlab::picture::{SERIES, Style};
/// let plan = Style::new(SERIES[1]).dashed().width(2.0).labelled("plan");
/// # assert_eq!(plan, plan.clone());
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Style {
    /// Colour of lines, points and areas.
    pub colour: Colour,
    /// Width of a line, or diameter of a point, in pixels.
    pub width: f64,
    /// Opacity: 0 is invisible, 1 opaque.
    pub opacity: f64,
    /// Opacity of an area's inside: 0 is empty, 1 opaque.
    pub fill: f64,
    /// Whether lines are dashed.
    pub dashed: bool,
    /// Label in the legend.
    pub label: Option<String>,
}

impl Style {
    /// A solid line of medium width, or solid dots, without a label.
    pub const fn new(colour: Colour) -> Self {
        Self { colour, width: 2.0, opacity: 1.0, fill: 0.0, dashed: false, label: None }
    }

    /// Style of a true path.
    pub fn true_path() -> Self {
        Self::new(SERIES[0]).width(2.6).labelled("true path")
    }

    /// Style of a path by odometry.
    pub fn odometry() -> Self {
        Self::new(ODOMETRY).width(2.0).dashed().labelled("odometry")
    }

    /// Style of a planned path.
    pub fn plan() -> Self {
        Self::new(GREEN).width(1.6).dashed().labelled("plan")
    }

    /// Style of lidar points.
    pub fn lidar() -> Self {
        Self::new(CLOUD).width(3.0).opacity(0.6).labelled("lidar hits")
    }

    /// A thin gray auxiliary line.
    pub fn aid() -> Self {
        Self::new(PALE_INK).width(1.0).opacity(0.7)
    }

    /// Sets the colour.
    #[must_use]
    pub fn colour(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    /// Sets the width of a line, or the diameter of a point, in pixels: 0.2 to 40.
    #[must_use]
    pub fn width(self, pixels: f64) -> Self {
        Self { width: within(pixels, 0.2, 40.0), ..self }
    }

    /// Sets the opacity: 0 is invisible, 1 opaque.
    #[must_use]
    pub fn opacity(self, opacity: f64) -> Self {
        Self { opacity: within(opacity, 0.0, 1.0), ..self }
    }

    /// Fills areas with this opacity: 0 leaves them empty, 1 hides what is below.
    #[must_use]
    pub fn filled(self, opacity: f64) -> Self {
        Self { fill: within(opacity, 0.0, 1.0), ..self }
    }

    /// Makes lines dashed.
    #[must_use]
    pub fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }

    /// Sets the label in the legend. Equal labels share one entry, which shows the first style.
    #[must_use]
    pub fn labelled(self, label: impl Into<String>) -> Self {
        Self { label: Some(label.into()), ..self }
    }
}

/// Clamps a number; NaN gives the lower limit.
fn within(value: f64, low: f64, high: f64) -> f64 {
    if value.is_nan() { low } else { value.clamp(low, high) }
}
