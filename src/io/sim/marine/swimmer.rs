use super::{CraftDrive, Waters};
use crate::geometry::{Aabb, Point, Point3, Pose, Pose3, Vector, Vector3, math};
use crate::io::sim::TICK;
use crate::io::sim::shove::stopping;
use crate::kinematics::marine::{Craft, CraftMotion, CraftState, HullPart, Wrench};
use crate::world::HeightField;

/// A craft in a world.
#[derive(Debug)]
pub(in crate::io::sim) struct Swimmer {
    craft: Craft,
    state: CraftState,
    /// Points of the hull that may meet the ground.
    points: Vec<Vector3>,
    windage: Vector,
    /// How far the hull reaches ahead and to the side (m).
    half: [f64; 2],
    /// Distance that the hull may move before the ground is checked again (m).
    clearance: f64,
    /// Ticks since the hull touched the ground.
    free_ticks: u32,
    /// Speed of the water around it in the last tick (m/s), where it was before that, and whether something
    /// was in its way.
    flow: Vector3,
    before: Point3,
    held: bool,
    broken: bool,
}

/// Where the hull is below the ground.
struct Contact {
    place: Vector3,
    normal: Vector3,
    depth: f64,
}

/// Number of ticks without touch after which the next touch is another contact.
const ANOTHER: u32 = 20;
/// Coefficient of friction between hull and ground.
const FRICTION: f64 = 0.3;
/// Number of iterations over all contacts per tick.
const ROUNDS: usize = 8;
/// Fraction of its depth by which a hull leaves the ground in a tick.
const EMERGING: f64 = 0.2;
/// Distance around a craft within which ground is considered (m).
const LOOK_AHEAD: f64 = 0.5;
/// Maximum speed of a craft (m/s): a faster one would cross walls and worlds within a tick.
const FASTEST: f64 = 100.0;
/// The least cosine of a pitch at which a craft still has a heading.
const STEEPEST: f64 = 0.1;
/// Half of the density of air times the drag coefficient of a hull, in kg/m³.
const AIR: f64 = 0.6;

impl Swimmer {
    pub(in crate::io::sim) fn new(craft: Craft, windage: [f64; 2]) -> Self {
        let state = CraftState::at_rest(&craft, &Pose3::default());
        let points = craft.hull().iter().flat_map(points).collect();
        let windage = Vector::from(windage);
        let half = [0, 1].map(|axis| {
            let end = |part: &HullPart| part.centre()[axis].abs() + part.half_size()[axis];
            craft.hull().iter().map(end).fold(0.0, f64::max)
        });
        Self {
            craft,
            state,
            points,
            windage,
            half,
            clearance: 0.0,
            free_ticks: ANOTHER,
            flow: Vector3::zeros(),
            before: Point3::origin(),
            held: false,
            broken: false,
        }
    }

    /// Puts it somewhere: so many metres above the ground; at 0, where it comes to rest: afloat, or on the
    /// ground.
    pub(in crate::io::sim) fn place(
        &mut self,
        ground: &HeightField,
        waters: &Waters,
        pose: Pose,
        elevation: f64,
    ) {
        let level = ground.height(pose.position()).unwrap_or(0.0);
        let stands = level - self.keel();
        let z = if elevation > 0.0 { stands + elevation } else { self.rest(stands, waters, pose) };
        self.state = CraftState::at_rest(&self.craft, &Pose3::level(pose, z));
        (self.clearance, self.free_ticks, self.broken) = (0.0, ANOTHER, false);
    }

    /// The height of the lowest point of a level hull in the craft's own frame.
    fn keel(&self) -> f64 {
        self.craft.middle().z + self.craft.lowest(&nalgebra::UnitQuaternion::identity())
    }

    /// The height at which a level craft floats, or stands on the ground.
    fn rest(&self, ground: f64, waters: &Waters, pose: Pose) -> f64 {
        let still = waters.around(pose.position(), waters.level(), [Vector::zeros(); 2], 0.0);
        let still = crate::kinematics::marine::LocalWater { slope: Vector::zeros(), ..still };
        let lift = |z: f64| {
            let state = CraftState::at_rest(&self.craft, &Pose3::level(pose, z));
            still.density * self.craft.displaced(&state, &still).volume
        };
        let mass = self.craft.mass();
        let (mut low, mut high) = (ground, waters.level() - self.keel());
        if low >= high || lift(low) <= mass {
            return ground;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if lift(middle) > mass { low = middle } else { high = middle }
        }
        low
    }

    pub(in crate::io::sim) fn pose(&self) -> Pose3 {
        self.state.pose(&self.craft)
    }

    /// Whether its numbers have come to an end, so that it stays where it was.
    pub(in crate::io::sim) fn is_broken(&self) -> bool {
        self.broken
    }

    /// The speed over ground in the craft's own frame, at its origin.
    pub(in crate::io::sim) fn velocity(&self) -> CraftMotion {
        let CraftMotion { linear, angular } = self.state.velocity;
        CraftMotion { linear: linear - angular.cross(&self.craft.middle().coords), angular }
    }

    /// A motion in the craft's own frame as it is ahead, to the left and about the upright: where waves rock a
    /// craft, what it moves along its own axes adds up to another way.
    fn levelled(&self, motion: &CraftMotion) -> CraftMotion {
        let [roll, pitch, _] = self.pose().roll_pitch_yaw();
        let tilt = Pose3::from_angles(Point3::origin(), roll, pitch, 0.0);
        let (sin, cos) = math::sin_cos(roll);
        let upright = (motion.angular.y * sin + motion.angular.z * cos) / math::cos(pitch).max(STEEPEST);
        CraftMotion { linear: tilt.rotate(motion.linear), angular: Vector3::z() * upright }
    }

    /// Moves it for a tick as its drive commands. Returns where it has come to touch the ground.
    pub(in crate::io::sim) fn step(
        &mut self,
        ground: &HeightField,
        waters: &Waters,
        drive: &mut CraftDrive,
        time: f64,
    ) -> Option<Point> {
        if self.broken {
            return None;
        }
        let before = self.state;
        (self.before, self.held) = (self.pose().position, false);
        let hull = [Vector3::x() * self.half[0], Vector3::y() * self.half[1]];
        let hull = hull.map(|half| (self.state.attitude * half).xy());
        let water = waters.around(self.state.position.xy(), self.state.position.z, hull, time);
        let commands = drive.commands();
        let wind = self.wind(waters);
        if wind == Wrench::NONE {
            self.craft.advance(&mut self.state, &commands, &water);
        } else {
            self.craft.advance_under(&mut self.state, &commands, &water, |_| wind);
        }
        let touched = self.meet(ground);
        if !self.is_sound() {
            (self.state, self.broken) = (before, true);
            self.state.velocity = CraftMotion::STILL;
            return None;
        }
        self.flow = water.velocity;
        touched
    }

    /// Lets its drive measure how it has moved in a tick, once obstacles have taken their part of that.
    pub(in crate::io::sim) fn measure(&self, ground: &HeightField, drive: &mut CraftDrive) {
        if self.broken {
            return;
        }
        let (own, mut over) = (self.state.attitude.inverse(), self.velocity());
        if self.held {
            // The speed at the end of a tick is not that of a craft which an obstacle holds in each.
            over.linear = own * ((self.pose().position - self.before) / TICK);
        }
        let flow = own * self.flow;
        let through = CraftMotion { linear: over.linear - flow, ..over };
        let [through, over] = [through, over].map(|motion| self.levelled(&motion));
        let place = self.state.position;
        let altitude = place.z - ground.height(place.xy()).unwrap_or(0.0);
        drive.sense(&through, &over, altitude);
    }

    /// Whether its numbers are of a craft that could be: finite, and no faster than any.
    fn is_sound(&self) -> bool {
        let CraftMotion { linear, angular } = self.state.velocity;
        self.state.is_finite() && linear.norm() < FASTEST && angular.norm() * self.craft.reach() < FASTEST
    }

    /// Wind force on the part above the water; zero for a submerged craft.
    fn wind(&self, waters: &Waters) -> Wrench {
        let wind = waters.wind();
        let above = self.state.position.z + self.craft.highest(&self.state.attitude);
        if wind == Vector::zeros() || above < waters.level() {
            return Wrench::NONE;
        }
        let own =
            self.state.attitude.inverse() * Vector3::new(wind.x, wind.y, 0.0) - self.state.velocity.linear;
        let force = Vector3::new(self.windage.x * own.x, self.windage.y * own.y, 0.0) * (AIR * own.norm());
        Wrench { force, moment: Vector3::zeros() }
    }

    /// Moves it aside, as something in the way of its outline does, and takes the speed that led it there.
    pub(in crate::io::sim) fn shove(&mut self, aside: Vector, turned: f64) {
        let way = Vector3::new(aside.x, aside.y, 0.0);
        let pose = self.pose();
        let turn = Pose3::level(Pose::new(0.0, 0.0, turned), 0.0).attitude;
        self.state.attitude = turn * self.state.attitude;
        self.state.position = pose.position + way + self.state.attitude * self.craft.middle().coords;
        let own = self.state.attitude.inverse();
        let CraftMotion { linear, angular } = &mut self.state.velocity;
        *linear += stopping(linear, &(own * (way / TICK)));
        *angular += stopping(angular, &(own * Vector3::new(0.0, 0.0, turned / TICK)));
        self.clearance = 0.0;
        self.held = true;
    }

    /// Stops what of the hull has come into the ground. Returns where, if it is another contact.
    fn meet(&mut self, ground: &HeightField) -> Option<Point> {
        self.free_ticks = self.free_ticks.saturating_add(1);
        let CraftMotion { linear, angular } = self.state.velocity;
        self.clearance -= (linear.norm() + self.craft.reach() * angular.norm()) * TICK;
        if self.clearance > 0.0 {
            return None;
        }
        self.clearance = self.free_way(ground);
        if self.clearance > 0.0 {
            return None;
        }
        let contacts = self.contacts(ground);
        let first = contacts.first()?;
        let place = self.state.position + self.state.attitude * first.place;
        self.stop_at(&contacts);
        let another = self.free_ticks >= ANOTHER;
        self.free_ticks = 0;
        another.then(|| place.xy())
    }

    /// Distance that the hull can certainly move without touching the ground (m).
    fn free_way(&self, ground: &HeightField) -> f64 {
        let lowest = self.state.position.z + self.craft.lowest(&self.state.attitude);
        let free = |around: f64| {
            let side = Vector::repeat(self.craft.reach() + around);
            let area = Aabb::new(self.state.position.xy() - side, self.state.position.xy() + side);
            (lowest - ground.upper_bound(&area)).min(around)
        };
        let wide = free(LOOK_AHEAD);
        if wide > 0.0 { wide } else { free(0.2 * LOOK_AHEAD).max(0.0) }
    }

    fn contacts(&self, ground: &HeightField) -> Vec<Contact> {
        let inward = self.state.attitude.inverse();
        let contact = |&place: &Vector3| {
            let at = self.state.position + self.state.attitude * place;
            let (level, slope) = ground.height_and_gradient(at.xy())?;
            let normal = Vector3::new(-slope.x, -slope.y, 1.0).normalize();
            let depth = (level - at.z) * normal.z;
            (depth > 0.0).then(|| Contact { place, normal: inward * normal, depth })
        };
        self.points.iter().filter_map(contact).collect()
    }

    /// Takes the speeds at which contacts move into the ground, and rubs along it.
    fn stop_at(&mut self, contacts: &[Contact]) {
        let mut pressed = vec![0.0; contacts.len()];
        for _ in 0..ROUNDS {
            for (contact, pressed) in contacts.iter().zip(&mut pressed) {
                let speed = self.speed_at(&contact.place);
                let into = speed.dot(&contact.normal);
                let impulse = -into / self.craft.mobility(&contact.place, &contact.normal);
                let change = impulse.max(-*pressed);
                *pressed += change;
                self.strike(&contact.place, &(contact.normal * change));
            }
        }
        for (contact, pressed) in contacts.iter().zip(&pressed) {
            let speed = self.speed_at(&contact.place);
            let along = speed - contact.normal * speed.dot(&contact.normal);
            let Some(way) = along.try_normalize(1e-9) else { continue };
            let stop = along.norm() / self.craft.mobility(&contact.place, &way);
            self.strike(&contact.place, &(way * -stop.min(FRICTION * pressed)));
        }
        let mut out = Vector3::zeros();
        for contact in contacts {
            let missing = contact.depth - out.dot(&contact.normal);
            out += contact.normal * missing.max(0.0);
        }
        self.state.position += self.state.attitude * (out * EMERGING);
    }

    fn speed_at(&self, place: &Vector3) -> Vector3 {
        self.state.velocity.linear + self.state.velocity.angular.cross(place)
    }

    fn strike(&mut self, place: &Vector3, impulse: &Vector3) {
        self.state.velocity = self.craft.struck(&self.state.velocity, place, impulse);
    }
}

/// Points of a part's surface: its corners, or those along it and around it.
fn points(part: &HullPart) -> Vec<Vector3> {
    let (centre, half) = (part.centre().coords, part.half_size());
    let at = |x: f64, y: f64, z: f64| centre + Vector3::new(x * half.x, y * half.y, z * half.z);
    let signs = [1.0, -1.0];
    let corners =
        signs.into_iter().flat_map(|x| signs.into_iter().flat_map(move |y| signs.map(|z| (x, y, z))));
    match *part {
        HullPart::Capsule { radius, length, axis, .. } => {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut points = Vec::new();
            for along in signs {
                let mut tip = centre;
                tip[axis] += along * 0.5 * length;
                points.push(tip);
            }
            for along in [-1.0, 0.0, 1.0] {
                for (a, b) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
                    let mut point = centre;
                    point[axis] += along * (0.5 * length - radius);
                    (point[next], point[last]) = (point[next] + a * radius, point[last] + b * radius);
                    points.push(point);
                }
            }
            points
        }
        HullPart::Ellipsoid { .. } => {
            let slant = (1.0_f64 / 3.0).sqrt();
            let tips = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)];
            let tips =
                tips.into_iter().flat_map(|(x, y, z)| signs.map(|sign| at(sign * x, sign * y, sign * z)));
            tips.chain(corners.map(|(x, y, z)| at(slant * x, slant * y, slant * z))).collect()
        }
        HullPart::Box { .. } => corners.map(|(x, y, z)| at(x, y, z)).collect(),
    }
}
