//! Places where arrows tell cars to turn off.

use crate::geometry::angle_difference;
use crate::random::Stream;
use crate::world::road::{RightOfWay, RoadCourse, RoadMark, RoadMarkKind, RoadSide};

/// A mandatory turn at a crossing of the road with itself, onto the later part of the road.
///
/// ```
/// use roverlab::drive::traffic::RoadTurn;
/// use roverlab::world::formats::course;
/// use roverlab::world::road::RoadSide;
/// let eight = "course 1\nstraight 2000\narrow right\nstraight 1000\ncrossing 90 none stop\nstraight 3000\n\
///     arc 3000 270\nstraight 3000\ncrossing 90 none\nstraight 3000\narc 3000 -270\n";
/// let course = course::parse(eight, "eight")?;
/// let [turn] = RoadTurn::of(&course)[..] else { panic!("one turn") };
/// assert_eq!((turn.from, turn.side), (3.0, RoadSide::Right));
/// assert!((turn.skipped() - 20.14).abs() < 0.01);
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadTurn {
    /// The crossing's middle along the line on the part of the road that ends there (m).
    pub from: f64,
    /// The same on the part where cars drive on (m).
    pub to: f64,
    /// Side to which they turn.
    pub side: RoadSide,
}

/// Distances of an arrow's beginning before the middle of its crossing (m): it is 500 mm long, and ends 50 to
/// 250 mm before the line by the rules.
const ARROW: std::ops::Range<f64> = 0.6..1.6;

/// Distances of an arrow's end before its line, by the rules (m).
const BEFORE: [f64; 2] = [0.05, 0.25];
/// Length of an arrow, and width of the line, by the rules (m).
const LONG: (f64, f64) = (0.5, 0.038);
/// Free road before the middle of a crossing at which cars turn off, and behind it (m): there, cars are in
/// their lane.
const FREE: f64 = 2.6;

impl RoadTurn {
    /// The turns of a course. An arrow that leads back to an earlier part, or against the direction of the
    /// road, is none.
    pub fn of(course: &RoadCourse) -> Vec<Self> {
        let turn = |(from, to): (f64, f64)| {
            let side = side(course, (from, to));
            let tells =
                |mark: &RoadMark| mark.kind == RoadMarkKind::Arrow(side) && ARROW.contains(&(from - mark.at));
            course.marks.iter().any(tells).then_some(Self { from, to, side })
        };
        course.own_crossings().into_iter().filter_map(turn).collect()
    }

    /// Length of the road that is not driven (m).
    pub fn skipped(&self) -> f64 {
        self.to - self.from
    }

    /// Whether a place along the line is on that part of the road (m).
    pub(super) fn skips(&self, along: f64) -> bool {
        (self.from..self.to).contains(&along)
    }
}

fn is_number(mark: &RoadMark) -> bool {
    matches!(mark.kind, RoadMarkKind::Speed(..))
}

/// Side to which the later part of a road leads on at a crossing with itself.
fn side(course: &RoadCourse, (from, to): (f64, f64)) -> RoadSide {
    let [here, there] = [from, to].map(|at| course.line.at(at).pose.heading);
    if angle_difference(there, here) > 0.0 { RoadSide::Left } else { RoadSide::Right }
}

/// Makes cars turn off in every other course at the scale of the rules that crosses itself, unless it has
/// an arrow that says so: puts one before the crossing, where they give way, and ends no speed zone on the
/// other part of the road. Returns the part of the road where nothing else is to be put (m).
pub(super) fn draw_turn(course: &mut RoadCourse, random: &mut Stream) -> Option<(f64, f64)> {
    let (from, to) = course.own_crossings().first().copied().filter(|_| random.chance(0.5))?;
    if !RoadTurn::of(course).is_empty() {
        return None;
    }
    let halts = [RightOfWay::Stop, RightOfWay::GiveWay][random.below(2)];
    let before = random.between(BEFORE[0], BEFORE[1]);
    let (_, crossing) = course.crossings().find(|(at, _)| *at == from)?;
    let reach = course.crossing_reach(&crossing);
    for mark in &mut course.marks {
        let RoadMarkKind::Crossing(crossing) = &mut mark.kind else { continue };
        if mark.at == from {
            crossing.right_of_way = halts;
        } else if mark.at == to {
            crossing.right_of_way = RightOfWay::Priority;
        }
    }
    // A zone has to begin and end on the part that is driven.
    let is_skipped = |at: f64| (from..to).contains(&at);
    let numbers: Vec<f64> = course.marks.iter().filter(|it| is_number(it)).map(|it| it.at).collect();
    let nexts = numbers.iter().cycle().skip(1);
    let broken =
        |&(at, next): &(&f64, &f64)| is_skipped(*at) || is_skipped(*next) || (*at < from && *next >= to);
    let broken: Vec<f64> = numbers.iter().zip(nexts).filter(broken).map(|(at, _)| *at).collect();
    course
        .marks
        .retain(|mark| !matches!(mark.kind, RoadMarkKind::Speed(_, false)) || !broken.contains(&mark.at));
    let at = from - reach - LONG.1 - before - LONG.0;
    let kind = RoadMarkKind::Arrow(side(course, (from, to)));
    course.marks.push(RoadMark { at, kind });
    course.marks.sort_by(|a, b| a.at.total_cmp(&b.at));
    Some((from - FREE, to + FREE))
}
