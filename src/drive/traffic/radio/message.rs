use std::fmt;
use std::str::FromStr;

use crate::geometry::Pose;

/// What a car tells the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarReport {
    /// Pose in the frame that all cars share.
    pub pose: Pose,
    /// Speed (m/s).
    pub speed: f64,
    /// Curvature of its lane, positive to the left (1/m).
    pub curvature: f64,
    /// Whether it is in its own lane.
    pub is_in_lane: bool,
    /// What it is about to do.
    pub intent: CarIntent,
}

/// What a car is about to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CarIntent {
    /// Drives on.
    Drive,
    /// Lets another car go first.
    GiveWay,
    /// Stands until it has waited long enough, or until it is told to go.
    Stand,
}

/// A message between cars and their base station: a short text without a zero byte, which RoBIOS cannot send.
///
/// ```
/// use roverlab::drive::traffic::RoadMessage;
/// let text = "car 1.200 -0.310 0.05 0.90 0.00 own give-way";
/// let message: RoadMessage = text.parse().expect("a report");
/// assert_eq!(message.to_string(), text);
/// assert_eq!("stop".parse(), Ok(RoadMessage::Stop));
/// assert!("car 1 2".parse::<RoadMessage>().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RoadMessage {
    /// A car's report.
    Car(CarReport),
    /// Order of the base station to stand.
    Stop,
    /// Order of the base station to drive on.
    Go,
}

const INTENTS: [(CarIntent, &str); 3] =
    [(CarIntent::Drive, "drive"), (CarIntent::GiveWay, "give-way"), (CarIntent::Stand, "stand")];
/// Whether a car is in its own lane.
const LANES: [(bool, &str); 2] = [(true, "own"), (false, "other")];

/// The word of a value.
fn word<T: PartialEq>(words: &[(T, &'static str)], value: &T) -> &'static str {
    words.iter().find(|(other, _)| other == value).map_or("", |(_, word)| word)
}

/// The value of a word.
fn value<T: Copy>(words: &[(T, &str)], text: &str) -> Option<T> {
    words.iter().find(|(_, word)| *word == text).map(|(value, _)| *value)
}

impl fmt::Display for RoadMessage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stop => f.write_str("stop"),
            Self::Go => f.write_str("go"),
            Self::Car(CarReport { pose, speed, curvature, is_in_lane, intent }) => write!(
                f,
                "car {:.3} {:.3} {:.2} {speed:.2} {curvature:.2} {} {}",
                pose.x,
                pose.y,
                pose.heading,
                word(&LANES, is_in_lane),
                word(&INTENTS, intent)
            ),
        }
    }
}

impl FromStr for RoadMessage {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let words: Vec<&str> = text.split(' ').collect();
        let number = |word: &str| word.parse().ok().filter(|number: &f64| number.is_finite()).ok_or(());
        match *words.as_slice() {
            ["stop"] => Ok(Self::Stop),
            ["go"] => Ok(Self::Go),
            ["car", x, y, heading, speed, curvature, lane, intent] => Ok(Self::Car(CarReport {
                pose: Pose::new(number(x)?, number(y)?, number(heading)?),
                speed: number(speed)?,
                curvature: number(curvature)?,
                is_in_lane: value(&LANES, lane).ok_or(())?,
                intent: value(&INTENTS, intent).ok_or(())?,
            })),
            _ => Err(()),
        }
    }
}

impl RoadMessage {
    /// A message as received; `None` for any other.
    pub(super) fn read(data: &[u8]) -> Option<Self> {
        std::str::from_utf8(data).ok()?.parse().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(64))]
        #[test]
        fn reports_are_read_as_written(
            [x, y, heading, speed, curvature] in prop::array::uniform5(-3.0..3.0f64),
            is_in_lane in any::<bool>(), intent in 0..3_usize,
        ) {
            let intent = INTENTS[intent].0;
            let report = CarReport { pose: Pose::new(x, y, heading), speed, curvature, is_in_lane, intent };
            let read = RoadMessage::read(RoadMessage::Car(report).to_string().as_bytes());
            let Some(RoadMessage::Car(read)) = read else { panic!("{read:?}") };
            prop_assert!(read.pose.distance_to(report.pose.position()) < 1e-3);
            prop_assert!((read.pose.heading - heading).abs() < 6e-3 && (read.speed - speed).abs() < 6e-3);
            prop_assert_eq!((read.is_in_lane, read.intent), (is_in_lane, intent));
        }
    }

    #[test]
    fn other_messages_are_ignored() {
        let others = ["", "car", "car nan 0 0 0 0 own drive", "car 1 2 3 4 5 own fly", "stop now"];
        assert!(others.iter().all(|text| RoadMessage::read(text.as_bytes()).is_none()));
        assert!(RoadMessage::read(&[0xff, 0xfe]).is_none());
    }
}
