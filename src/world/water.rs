use crate::ParameterError;
use crate::geometry::Vector;
use crate::parameter::{require, require_finite, require_not_negative, require_positive};

/// The water of a world: what fills it up to [`World::water_level`](super::World::water_level).
#[derive(Debug, Clone, PartialEq)]
pub struct Water {
    /// Density (kg/m³).
    pub density: f64,
    /// Layers of the current: depth below the surface (m), and velocity along x and y (m/s). Between layers
    /// it is interpolated; above the first and below the last it is constant.
    pub current: Vec<(f64, Vector)>,
    /// Waves on the surface.
    pub waves: Option<Waves>,
    /// Velocity of the wind along x and y (m/s).
    pub wind: Vector,
    /// Fraction of the light scattered per metre of water (1/m): 0 in clear water, 0.1 in a filtered pool, 1
    /// in a lake. It veils distant objects in camera images.
    pub turbidity: f64,
}

/// Waves of small height on deep water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waves {
    /// Height from trough to crest (m): of regular waves, or the mean of the highest third of irregular ones.
    pub height: f64,
    /// Period (s): of regular waves, or of the peak of the spectrum.
    pub period: f64,
    /// Direction of travel, counter-clockwise from the x axis (rad).
    pub direction: f64,
    /// Whether they have the spectrum of the North Sea (JONSWAP) instead of a single frequency.
    pub irregular: bool,
}

impl Default for Water {
    /// Still, clear fresh water.
    fn default() -> Self {
        Self { density: 1000.0, current: Vec::new(), waves: None, wind: Vector::zeros(), turbidity: 0.0 }
    }
}

impl Water {
    /// Maximum density (kg/m³); the Dead Sea has 1240.
    pub const DENSEST: f64 = 2000.0;
    /// Maximum speed of current and wind (m/s).
    pub const FASTEST: f64 = 100.0;
    /// Maximum turbidity (1/m): nothing is visible at a hand's breadth.
    pub const MURKIEST: f64 = 100.0;

    /// Velocity of the current at a depth below the surface (m).
    ///
    /// ```
    /// use roverlab::geometry::Vector;
    /// use roverlab::world::Water;
    /// let layers = vec![(0.0, Vector::new(0.2, 0.0)), (2.0, Vector::zeros())];
    /// let water = Water { current: layers, ..Water::default() };
    /// assert!((water.current_at(0.5) - Vector::new(0.15, 0.0)).norm() < 1e-12);
    /// assert_eq!((water.current_at(-1.0).x, water.current_at(9.0).x), (0.2, 0.0));
    /// ```
    pub fn current_at(&self, depth: f64) -> Vector {
        let Some(below) = self.current.iter().position(|layer| layer.0 > depth) else {
            return self.current.last().map_or_else(Vector::zeros, |layer| layer.1);
        };
        let Some(above) = below.checked_sub(1) else { return self.current[0].1 };
        let ((top, upper), (bottom, lower)) = (self.current[above], self.current[below]);
        upper + (lower - upper) * ((depth - top) / (bottom - top))
    }

    /// Checks every value; the error names the one out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("water's density", self.density)?;
        let light = self.density <= Self::DENSEST;
        require("water's density", self.density, light, "at most 2000 kg/m³")?;
        let clear = (0.0..=Self::MURKIEST).contains(&self.turbidity);
        require("water's turbidity", self.turbidity, clear, "0 to 100 per metre")?;
        let slow = |name: &'static str, speed: Vector| {
            // If one of the two is NaN, that one is wrong.
            let wrong = |part: &&f64| part.is_nan() || part.abs() > Self::FASTEST;
            let found = [speed.x, speed.y];
            let found = found.iter().find(wrong).copied().unwrap_or_default();
            require(name, found, found.abs() <= Self::FASTEST, "at most 100 m/s")
        };
        slow("wind", self.wind)?;
        let mut before = f64::NEG_INFINITY;
        for &(depth, speed) in &self.current {
            require_finite("current's depth", depth)?;
            require("current's depth", depth, depth > before, "more than that of the layer above")?;
            before = depth;
            slow("current", speed)?;
        }
        self.waves.as_ref().map_or(Ok(()), Waves::validate)
    }
}

impl Waves {
    fn validate(&self) -> Result<(), ParameterError> {
        require_not_negative("waves' height", self.height)?;
        require_finite("waves' direction", self.direction)?;
        let period = self.period;
        require("waves' period", period, (0.5..=30.0).contains(&period), "0.5 to 30 s")?;
        // Higher waves break.
        let most = 0.1 * self.length();
        require(
            "waves' height",
            self.height,
            self.height <= most,
            format!("at most a tenth of their length, {most} m"),
        )
    }

    /// Standard deviation of the surface's level (m).
    pub fn deviation(&self) -> f64 {
        if self.irregular { 0.25 * self.height } else { 0.5 * std::f64::consts::FRAC_1_SQRT_2 * self.height }
    }

    /// Wavelength in deep water (m).
    pub fn length(&self) -> f64 {
        9.81 * self.period * self.period / std::f64::consts::TAU
    }
}
