/// Kinds of a [`RoadElement`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum RoadElementKind {
    /// A stop line across the own lane; its place is its near edge.
    StopLine,
    /// A give-way line across the own lane; its place is its near edge.
    GiveWayLine,
    /// The chequered line where laps start.
    StartLine,
    /// A crosswalk; its place is its near edge.
    Zebra,
    /// A crossing with the arms that have been seen; its place is its middle.
    Crossing {
        /// Whether there is an arm on the left.
        left: bool,
        /// Whether there is an arm on the right.
        right: bool,
    },
    /// A box on the road. Its place is that of its foot.
    Obstacle {
        /// Its right side, to the left of the own lane's centre (m).
        right: f64,
        /// Its left side, to the left of the own lane's centre (m).
        left: f64,
    },
    /// A barred area in the own lane; its place is where it begins.
    Barred {
        /// Its right side, to the left of the own lane's centre (m).
        right: f64,
        /// Its left side, to the left of the own lane's centre (m).
        left: f64,
        /// Its length as far as it is in view (m).
        length: f64,
    },
    /// The number of a speed limit on the own lane (km/h at the scale of the rules: 36 are 1 m/s); its place
    /// is its near edge.
    SpeedLimit(u8),
    /// A turn arrow on the own lane; its place is its near edge.
    TurnArrow {
        /// Whether it points to the left.
        left: bool,
    },
    /// The number of a speed limit that ends, struck out; its place is its near edge.
    SpeedLimitEnd,
    /// A parking area beside the road; its place is where it begins.
    Parking {
        /// Whether it is on the left, with spots across the road.
        left: bool,
    },
}

/// Something on the road ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadElement {
    /// What it is.
    pub kind: RoadElementKind,
    /// Distance ahead of the robot's origin along the road (m); negative once it is behind.
    pub ahead: f64,
    /// Its speed along the road (m/s), for obstacles; otherwise 0.
    pub speed: f64,
}

/// What one image shows, at the scale of the rules.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detection {
    pub(super) kind: RoadElementKind,
    pub(super) ahead: f64,
    /// Whether the limits of the view cut nothing of it.
    pub(super) is_whole: bool,
}

impl Detection {
    pub(super) fn new(kind: RoadElementKind, ahead: f64) -> Self {
        Self { kind, ahead, is_whole: true }
    }
}
