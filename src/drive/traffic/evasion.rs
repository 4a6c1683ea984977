use super::actors::{STANDS, TrafficActors, between};
use super::encounter::{Encounter, Moment, encounters};
use super::scene::TrafficScene;
use super::score::EvasionScore;
use super::turn::RoadTurn;
use crate::drive::outline::Outline;
use crate::geometry::{Point, Pose};
use crate::world::road::{LanePose, RoadCourse, Traffic};
use crate::world::{DriveSpec, Footprint, RobotSpec};

/// The referee of Obstacle Evasion by the rules of 2025. It sees the true poses of a car and of the boxes on
/// a course, and does not reveal them to the car.
///
/// Each element counts once a lap, when the car's front has left it behind:
///
/// | element | right | fault |
/// |---|---|---|
/// | obstacle | passed, back in the lane within 2 m | touched |
/// | oncoming obstacle | no wheel in its lane while it is within 1 m of what blocks the own one | touched |
/// | obstacle in a no-passing zone | at least 300 mm behind it | touched; two wheels over the solid line |
/// | barred area | no wheel in it | |
/// | stop line | stood at most 150 mm before it for 3 s | did not stand |
/// | give-way line | the same for 1 s | |
/// | turn | the halt of the line, and then driven on the part of the road to which the arrow leads | did not stand before a stop line |
/// | traffic from the right | stood until it had crossed the road | touched |
/// | crosswalk | did not stand | |
/// | crosswalk with a pedestrian | stood for 3 s, and until the road was free | touched |
///
/// All other encounters are neutral. Leaving the lane away from obstacles costs 2 points, at most ten times,
/// and driving too fast in a speed zone 5. The run ends when the laps are driven, or when the car strays or
/// stands for 15 s, which counts as an intervention by remote control.
///
/// ```
/// use roverlab::drive::traffic::{ObstacleEvasion, TrafficActors, TrafficScene};
/// use roverlab::world::RobotSpec;
/// use roverlab::world::formats::course;
/// let text = "course 1\nstraight 3000\nzebra\nstraight 3000\narc 1500 180\nstraight 6000\narc 1500 180\n";
/// let scene = TrafficScene { course: course::parse(text, "oval")?, boxes: Vec::new() };
/// let mut referee = ObstacleEvasion::new(scene.clone(), &RobotSpec::road_car(), 1);
/// let actors = TrafficActors::new(scene.clone());
/// // A lap at 1 m/s: the crosswalk is empty, which is worth 10 points without a stop.
/// let is_over = (0..3000).any(|step| {
///     let time = 0.01 * f64::from(step);
///     referee.see(time, &scene.course.pose(time, 0.0), 1.0, &actors)
/// });
/// assert!(is_over && referee.score().points() == 10.0 && referee.possible() == 10.0);
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ObstacleEvasion {
    scene: TrafficScene,
    body: Body,
    laps: u32,
    score: EvasionScore,
    lane: LanePose,
    encounters: Vec<Encounter>,
    /// Distance driven along the line (m), and the time at which the car last moved (s).
    driven: f64,
    moved: f64,
    beyond: Beyond,
    /// Speed zones as in [`TrafficScene::speed_zones`], and whether the car drives too fast in one.
    zones: Vec<(f64, f64, f64)>,
    is_speeding: bool,
    turns: Vec<RoadTurn>,
}

/// Whether two wheels are over the centre line, and whether two are over the own lane's other edge.
#[derive(Debug, Clone, Copy, Default)]
struct Beyond {
    is_over_centre: bool,
    is_off_road: bool,
}

/// Outline of a car, and the points where its wheels touch the ground, in its frame (m).
#[derive(Debug, Clone)]
struct Body {
    back: f64,
    front: f64,
    half_width: f64,
    wheels: [Point; 4],
}

/// Distance from the lane's centre at which the car strays (edge distances); in the other lane it is 1.
const ASTRAY: f64 = 1.6;
/// Share by which a speed limit may be exceeded, as speed is measured from image to image.
const TOLERANCE: f64 = 0.05;
/// Standstill after which the car is taken over (s): longer than any halt.
const STUCK: f64 = 15.0;
/// Distance from a crossing's middle within which a car that turns off is between lanes (m).
const TURNS: f64 = 1.2;
/// Distance before an obstacle and behind it within which the car may be beside its lane (m): 2 m behind it
/// by the rules, and the car's own length.
const BESIDE: f64 = 2.6;

impl ObstacleEvasion {
    /// Creates the referee of a car that starts at the beginning of a course and drives some laps.
    pub fn new(scene: TrafficScene, car: &RobotSpec, laps: u32) -> Self {
        let lane = scene.course.locate(&scene.course.start(), Some(0.0));
        let (encounters, zones) = (encounters(&scene), scene.speed_zones());
        let turns = RoadTurn::of(&scene.course);
        Self {
            scene,
            body: Body::of(car),
            laps,
            score: EvasionScore::default(),
            lane,
            encounters,
            driven: 0.0,
            moved: 0.0,
            beyond: Beyond::default(),
            zones,
            is_speeding: false,
            turns,
        }
    }

    /// Result so far.
    pub fn score(&self) -> &EvasionScore {
        &self.score
    }

    /// Points that can be earned in all laps.
    pub fn possible(&self) -> f64 {
        let lap: f64 = self.encounters.iter().map(|it| it.element.points().0).sum();
        lap * f64::from(self.laps)
    }

    /// Position of the car's front along the line (m).
    pub fn front(&self) -> f64 {
        self.lane.along
    }

    /// Observes the car, its speed (m/s) and the boxes at a time (s). Returns whether the run is over. The
    /// actors are to be those of the referee's scene; boxes that they lack count as off the road.
    pub fn see(&mut self, time: f64, car: &Pose, speed: f64, actors: &TrafficActors) -> bool {
        self.score.time = time;
        let front = car.to_world(Point::new(self.body.front, 0.0));
        self.driven += self.locate(&Pose::new(front.x, front.y, car.heading));
        if speed.abs() > STANDS {
            self.moved = time;
        }
        self.watch_speed(speed);
        self.touch(car, actors);
        let watched = self.watch_lines(car, actors);
        self.judge(time, speed, watched, actors);
        let laps = (self.driven - self.body.front).max(0.0) / self.scene.course.line.length();
        self.score.laps = laps as u32;
        self.score.is_taken_over =
            self.lane.offset.abs() > ASTRAY * self.scene.course.edge() || time - self.moved > STUCK;
        self.score.is_taken_over || self.score.laps >= self.laps
    }

    /// Updates the lane by the pose of the front. Returns the distance gained along the line (m), with what a
    /// turn skips.
    fn locate(&mut self, front: &Pose) -> f64 {
        let (course, before) = (&self.scene.course, self.lane.along);
        self.lane = course.locate(front, Some(before));
        for turn in self.turns.iter().filter(|turn| (self.lane.along - turn.from).abs() < TURNS) {
            let other = course.locate(front, Some(turn.to));
            if other.heading.abs() < self.lane.heading.abs() && (other.along - turn.to).abs() < TURNS {
                self.lane = other;
                return other.along - before;
            }
        }
        between(course, before, self.lane.along)
    }

    /// Whether the car turns off, or has just done so.
    fn turns(&self) -> bool {
        let near = |at: f64| (self.lane.along - at).abs() < TURNS;
        self.turns.iter().any(|turn| near(turn.from) || near(turn.to))
    }

    /// Counts speed zones in which the car drives too fast with its front.
    fn watch_speed(&mut self, speed: f64) {
        let length = self.scene.course.line.length();
        let is_in = |from: f64, to: f64| {
            (0..=self.laps).any(|lap| (from..to).contains(&(self.driven - f64::from(lap) * length)))
        };
        let is_speeding =
            self.zones.iter().any(|&(from, to, limit)| speed > limit * (1.0 + TOLERANCE) && is_in(from, to));
        self.score.speedings += u32::from(is_speeding && !self.is_speeding);
        self.is_speeding = is_speeding;
    }

    /// Counts boxes that the car touches.
    fn touch(&mut self, car: &Pose, actors: &TrafficActors) {
        let body = &self.body;
        let outline = Outline::new(car, (body.back, body.front), body.half_width);
        for it in &mut self.encounters {
            let Some(index) = it.index else { continue };
            let Some(pose) = actors.pose(index) else { continue };
            let [length, width, _] = self.scene.boxes[index].size;
            let item = Outline::new(&pose, (-0.5 * length, 0.5 * length), 0.5 * width);
            if !it.is_touched && outline.touches(&item) {
                it.is_touched = true;
                self.score.collisions += 1;
            }
        }
    }

    /// Counts departures from the lane that no obstacle explains. Returns the wheels, as in [`Moment`], and
    /// whether two of them have just crossed the centre line.
    fn watch_lines(&mut self, car: &Pose, actors: &TrafficActors) -> ([(f64, f64); 4], bool) {
        let course = &self.scene.course;
        let half = 0.5 * course.edge();
        let side = if course.traffic == Traffic::Left { -1.0 } else { 1.0 };
        let wheels = self.body.wheels.map(|wheel| {
            let place = car.to_world(wheel);
            let lane = course.locate(&Pose::new(place.x, place.y, car.heading), Some(self.lane.along));
            (lane.along, -side * lane.offset)
        });
        let are_out = |side: f64| wheels.iter().filter(|(_, out)| side * out > half).count() >= 2;
        let (is_over_centre, is_off_road) = (are_out(-1.0), are_out(1.0));
        let is_beside = self.encounters.iter().filter(|it| it.is_obstacle(&self.scene)).any(|it| {
            it.place(actors).is_some_and(|(from, to)| {
                between(course, from, self.lane.along) > -BESIDE
                    && between(course, to, self.lane.along) < BESIDE
            })
        });
        let has_crossed = is_over_centre && !self.beyond.is_over_centre;
        let has_left_road = is_off_road && !self.beyond.is_off_road;
        // Who passes crosses the centre line alone; who turns off, either.
        let has_departed = has_left_road || has_crossed && !is_beside;
        self.score.departures += u32::from(has_departed && !self.turns());
        self.beyond = Beyond { is_over_centre, is_off_road };
        (wheels, has_crossed)
    }

    fn judge(&mut self, time: f64, speed: f64, watched: ([(f64, f64); 4], bool), actors: &TrafficActors) {
        let (wheels, has_crossed_centre) = watched;
        let course: &RoadCourse = &self.scene.course;
        let room = 0.5 * course.edge() - self.body.half_width;
        let moment = Moment {
            scene: &self.scene,
            actors,
            front: self.lane.along,
            driven: self.driven,
            time,
            speed,
            wheels,
            has_crossed_centre,
            is_back: self.lane.offset.abs() < room
                && !(self.beyond.is_over_centre || self.beyond.is_off_road),
        };
        for it in &mut self.encounters {
            if let Some((is_right, is_fault)) = it.judge(&moment) {
                self.score.row(it.element).count(is_right, is_fault);
            }
        }
    }
}

impl Body {
    fn of(car: &RobotSpec) -> Self {
        let (length, track) = match car.drive {
            DriveSpec::Ackermann { wheelbase, track, .. } => (wheelbase, track),
            DriveSpec::Differential { track, .. } => (0.0, track),
            _ => (0.0, 0.0),
        };
        let (back, front, half_width) = match car.footprint {
            Footprint::Rectangle(outline) => (outline.min.x, outline.max.x, 0.5 * outline.size().y),
            other => {
                let radius = other.bounding_radius();
                (-radius, radius, radius)
            }
        };
        let wheels = [(0.0, 0.5), (0.0, -0.5), (length, 0.5), (length, -0.5)];
        Self { back, front, half_width, wheels: wheels.map(|(x, side)| Point::new(x, side * track)) }
    }
}
