use super::colours::{CLOUD, GREEN, ODOMETRY, PALE_INK, SERIES};
use crate::world::Colour;

/// How a line, an area or a cloud of points looks, and what the legend calls it.
///
/// ```
/// use roverlab::picture::{SERIES, Style};
/// let plan = Style::new(SERIES[1]).dashed().width(2.0).labelled("plan");
/// # assert_eq!(plan, plan.clone());
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Style {
    /// The colour of lines, points and insides.
    pub colour: Colour,
    /// The width of a line or of a point, in pixels.
    pub width: f64,
    /// 0 is invisible, 1 opaque.
    pub opacity: f64,
    /// How far the inside of an area is filled: 0 is empty, 1 opaque.
    pub fill: f64,
    /// Whether lines are dashed.
    pub dashed: bool,
    /// What the legend calls it.
    pub label: Option<String>,
}

impl Style {
    /// A solid line of middle width, or solid dots, without a label.
    pub const fn new(colour: Colour) -> Self {
        Self { colour, width: 2.0, opacity: 1.0, fill: 0.0, dashed: false, label: None }
    }

    /// Where a robot really was.
    pub fn true_path() -> Self {
        Self::new(SERIES[0]).width(2.6).labelled("true path")
    }

    /// Where a robot believed to be.
    pub fn odometry() -> Self {
        Self::new(ODOMETRY).width(2.0).dashed().labelled("odometry")
    }

    /// Where a robot means to go.
    pub fn plan() -> Self {
        Self::new(GREEN).width(1.6).dashed().labelled("plan")
    }

    /// Where lidar beams ended.
    pub fn lidar() -> Self {
        Self::new(CLOUD).width(3.0).opacity(0.6).labelled("lidar hits")
    }

    /// A thin gray line that helps to read the picture.
    pub fn aid() -> Self {
        Self::new(PALE_INK).width(1.0).opacity(0.7)
    }

    /// The same in another colour.
    #[must_use]
    pub fn colour(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    /// The same with another width of the line or of a point, in pixels of the picture, 0.2 to 40.
    #[must_use]
    pub fn width(self, pixels: f64) -> Self {
        Self { width: within(pixels, 0.2, 40.0), ..self }
    }

    /// The same, more or less transparent: 0 is invisible, 1 opaque.
    #[must_use]
    pub fn opacity(self, opacity: f64) -> Self {
        Self { opacity: within(opacity, 0.0, 1.0), ..self }
    }

    /// The same with the inside filled, for areas: 0 leaves it empty, 1 hides what is below.
    #[must_use]
    pub fn filled(self, opacity: f64) -> Self {
        Self { fill: within(opacity, 0.0, 1.0), ..self }
    }

    /// The same with dashed lines.
    #[must_use]
    pub fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }

    /// The same with a line in the legend. Equal labels share one line, which shows the first style.
    #[must_use]
    pub fn labelled(self, label: impl Into<String>) -> Self {
        Self { label: Some(label.into()), ..self }
    }
}

/// The nearest number between two limits; the lower one for what is not a number.
fn within(value: f64, low: f64, high: f64) -> f64 {
    if value.is_nan() { low } else { value.clamp(low, high) }
}
