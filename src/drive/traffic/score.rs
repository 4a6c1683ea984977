/// Kinds of elements of Obstacle Evasion that a [`TrafficScene`](super::TrafficScene) has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum EvasionElement {
    /// A box that stands in the own lane: 10 points.
    StaticObstacle,
    /// A box that moves along the own lane where passing is allowed: 15 points.
    DynamicObstacle,
    /// The same in a no-passing zone: 5 points for staying behind it.
    NoPassing,
    /// A box that comes towards the car in the other lane: 5 points for giving way where the own lane is
    /// blocked.
    OncomingObstacle,
    /// A barred area in the own lane: 10 points for not entering it.
    BarredArea,
    /// A stop line, straight on: 5 points.
    StopLine,
    /// A give-way line, straight on: 5 points.
    GiveWayLine,
    /// A mandatory turn behind one of these lines: 15 points for the halt and the right turn.
    Turn,
    /// Traffic from the right at one of these lines: 10 points.
    CrossTraffic,
    /// A crosswalk without pedestrians: 10 points.
    EmptyCrosswalk,
    /// A crosswalk with a pedestrian: 15 points.
    Crosswalk,
}

impl EvasionElement {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::StaticObstacle,
        Self::DynamicObstacle,
        Self::NoPassing,
        Self::OncomingObstacle,
        Self::BarredArea,
        Self::StopLine,
        Self::GiveWayLine,
        Self::Turn,
        Self::CrossTraffic,
        Self::EmptyCrosswalk,
        Self::Crosswalk,
    ];

    /// Points for mastering it, and those lost by a fault (CAuDri-Challenge 2025).
    pub fn points(self) -> (f64, f64) {
        match self {
            Self::StaticObstacle | Self::CrossTraffic => (10.0, 10.0),
            Self::DynamicObstacle | Self::Crosswalk => (15.0, 10.0),
            Self::NoPassing | Self::OncomingObstacle => (5.0, 10.0),
            Self::StopLine => (5.0, 5.0),
            Self::Turn => (15.0, 5.0),
            Self::GiveWayLine => (5.0, 0.0),
            Self::EmptyCrosswalk | Self::BarredArea => (10.0, 0.0),
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::StaticObstacle => "static obstacle",
            Self::DynamicObstacle => "dynamic obstacle",
            Self::NoPassing => "no-passing zone",
            Self::OncomingObstacle => "oncoming obstacle",
            Self::BarredArea => "barred area",
            Self::StopLine => "stop line",
            Self::GiveWayLine => "give-way line",
            Self::Turn => "turn",
            Self::CrossTraffic => "cross traffic",
            Self::EmptyCrosswalk => "empty crosswalk",
            Self::Crosswalk => "crosswalk with pedestrian",
        }
    }
}

/// Number of encounters with an element, by their results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct EvasionRow {
    /// Encounters.
    pub seen: u32,
    /// Those that earn points.
    pub right: u32,
    /// Those that neither earn nor cost points.
    pub neutral: u32,
    /// Those that cost points.
    pub negative: u32,
}

impl EvasionRow {
    /// Adds an encounter: a fault counts before a success.
    pub(super) fn count(&mut self, is_right: bool, is_fault: bool) {
        self.seen += 1;
        self.negative += u32::from(is_fault);
        self.right += u32::from(is_right && !is_fault);
        self.neutral += u32::from(!is_right && !is_fault);
    }
}

/// Result of Obstacle Evasion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EvasionScore {
    /// Time since the start (s).
    pub time: f64,
    /// Completed laps.
    pub laps: u32,
    /// Rows of [`EvasionElement::ALL`].
    pub rows: [EvasionRow; EvasionElement::ALL.len()],
    /// Number of boxes that the car has touched.
    pub collisions: u32,
    /// Number of times that two wheels left the own lane away from obstacles.
    pub departures: u32,
    /// Number of times that the car drove faster than a speed zone allows.
    pub speedings: u32,
    /// Whether the car was taken over, which ends the run.
    pub is_taken_over: bool,
}

/// Points lost each time the car leaves the lane.
const DEPARTURE: f64 = 2.0;
/// Largest number of departures that count.
const MOST_DEPARTURES: u32 = 10;
/// Points lost each time that the car is too fast in a speed zone.
const SPEEDING: f64 = 5.0;
/// Points lost if the car is taken over by remote control.
const TAKEN_OVER: f64 = 5.0;

impl EvasionScore {
    /// Points of all elements, minus those for leaving the lane, for speeding and for remote control.
    pub fn points(&self) -> f64 {
        let rows = EvasionElement::ALL.iter().zip(&self.rows);
        let elements = rows.map(|(element, row)| {
            let (plus, minus) = element.points();
            plus * f64::from(row.right) - minus * f64::from(row.negative)
        });
        let lane = DEPARTURE * f64::from(self.departures.min(MOST_DEPARTURES));
        elements.sum::<f64>()
            - lane
            - SPEEDING * f64::from(self.speedings)
            - if self.is_taken_over { TAKEN_OVER } else { 0.0 }
    }

    /// Number of negative encounters.
    pub fn negative(&self) -> u32 {
        self.rows.iter().map(|row| row.negative).sum()
    }

    pub(super) fn row(&mut self, element: EvasionElement) -> &mut EvasionRow {
        let index = EvasionElement::ALL.iter().position(|it| *it == element);
        &mut self.rows[index.unwrap_or(0)]
    }
}
