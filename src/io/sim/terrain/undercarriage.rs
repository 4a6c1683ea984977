use std::f64::consts::FRAC_PI_4;

pub(in crate::io::sim) use crate::geometry::units::GRAVITY;
use crate::geometry::{Vector, Vector3, direction, math, units};
use crate::kinematics::{PlanarTwist, Tracked};
use crate::world::{DriveSpec, Footprint, RobotSpec};

/// Parts of a robot that can touch the ground, and their friction.
#[derive(Debug, Clone)]
pub(super) struct Undercarriage {
    /// Centre of mass in the robot's frame, whose origin is on the ground under the driven axle.
    pub(super) centre: Vector3,
    /// Square of the mean radius of gyration (m²).
    pub(super) gyration: f64,
    pub(super) feet: Vec<Foot>,
    /// Coefficient of friction.
    pub(super) friction: f64,
}

/// A point that may touch the ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct Foot {
    /// Position relative to the centre of mass.
    pub(super) place: Vector3,
    pub(super) grip: Grip,
    /// Sinking per acceleration of the body that it supports alone (s²).
    pub(super) softness: f64,
    /// Time constant with which it returns when unloaded (s): its damping over its stiffness. A body that it
    /// supports alone is damped critically.
    pub(super) relaxation: f64,
}

/// Directions of a foot's friction.
#[derive(Debug, Clone, Copy)]
pub(super) enum Grip {
    /// A part of a driven wheel or belt, which moves forwards with its axle and not sideways; with the axle's
    /// position from the robot's origin.
    Driven(Vector),
    /// A wheel that rolls freely along its axle's motion, and does not slide sideways.
    Rolling(Vector),
    /// A Mecanum wheel, which is held only along its roller's axis: the wheel's position and that axis.
    Roller(Vector, Vector),
    /// The body itself.
    Body,
    /// A castor, which rolls in any direction.
    Free,
}

/// Sinking of a body on all its wheels or corners (m).
const SAG: f64 = 1e-4;
/// The same of a body on belts of rubber (m). Stiff ones pass the load from point to point faster than a tick,
/// and where they skid to then depends on it.
const BELT_SAG: f64 = 1e-3;
/// The same of a body on springs, and their travel from there to the stop (m). Mecanum wheels need springs: a
/// rigid body on uneven ground stands on two that are diagonal and hold it along one direction only.
const SPRUNG: f64 = 3e-3;
/// Number of corners on which an overturned body rests.
const CORNERS: u32 = 4;
/// Angles from straight down of the points of a wheel that may touch the ground (degrees).
const RIM: [f64; 5] = [-60.0, -30.0, 0.0, 30.0, 60.0];
/// Position of the centre of mass between axle and castor, as a fraction.
const BETWEEN: f64 = 0.3;
/// Height of the centre of mass, as a fraction of the robot's.
const MIDDLE: f64 = 0.4;

impl Undercarriage {
    /// The undercarriage from a robot's description.
    ///
    /// A two-wheeled drive also stands on a castor at the farther end of the outline. Defaults replace
    /// missing data: the centre of mass is at two fifths of the height, near the driven axle or between the
    /// axles.
    pub(super) fn of(spec: &RobotSpec) -> Self {
        let (back, front) = ends(&spec.footprint);
        let mut feet = Vec::new();
        let ahead = match spec.drive {
            DriveSpec::Differential { wheel_diameter, track, .. } => {
                let castor = if front > -back { front } else { back };
                for side in [0.5, -0.5] {
                    let axle = Vector::new(0.0, side * track);
                    feet.extend(wheel(axle, 0.5 * wheel_diameter, Grip::Driven(axle), 3));
                }
                feet.push(Foot::stiff(Vector3::new(castor, 0.0, 0.0), Grip::Free, 3));
                BETWEEN * castor
            }
            DriveSpec::Tracked { wheel_diameter, track, length, width, .. } => {
                belts(&mut feet, Tracked { track, length, width }, 0.5 * wheel_diameter);
                0.0
            }
            DriveSpec::Ackermann { wheel_diameter, track, wheelbase, .. } => {
                for side in [0.5, -0.5] {
                    let (rear, steered) =
                        (Vector::new(0.0, side * track), Vector::new(wheelbase, side * track));
                    feet.extend(wheel(rear, 0.5 * wheel_diameter, Grip::Driven(rear), 4));
                    feet.extend(wheel(steered, 0.5 * wheel_diameter, Grip::Rolling(steered), 4));
                }
                0.5 * wheelbase
            }
            DriveSpec::Omni { wheel_diameter, track, wheelbase, .. } => {
                for (ahead, side) in [(0.5, 0.5), (0.5, -0.5), (-0.5, 0.5), (-0.5, -0.5)] {
                    let place = Vector::new(ahead * wheelbase, side * track);
                    let roller = Vector::new(1.0, -(ahead * side).signum()).normalize();
                    let stops: Vec<Foot> =
                        wheel(place, 0.5 * wheel_diameter, Grip::Roller(place, roller), 4).collect();
                    feet.extend(stops.iter().map(|stop| stop.sprung(4, SPRUNG)));
                    feet.extend(stops.iter().map(|stop| stop.raised(SPRUNG)));
                }
                0.0
            }
            DriveSpec::Craft(_) => 0.0,
        };
        feet.extend(chassis(spec, ahead));
        let centre = stated_centre(spec).unwrap_or(Vector3::new(ahead, 0.0, MIDDLE * spec.height));
        Self::new(feet, centre, gyration(spec), spec.friction)
    }

    /// An undercarriage of feet at positions relative to the robot's origin.
    pub(super) fn new(mut feet: Vec<Foot>, centre: Vector3, gyration: f64, friction: f64) -> Self {
        for foot in &mut feet {
            foot.place -= centre;
        }
        Self { centre, gyration, feet, friction }
    }
}

impl Foot {
    /// One of `number` feet on which a body sinks by `sag`.
    fn new(place: Vector3, grip: Grip, number: u32, sag: f64) -> Self {
        let softness = f64::from(number) * sag / GRAVITY;
        Self { place, grip, softness, relaxation: 2.0 * softness.sqrt() }
    }

    /// One of `number` stiff feet that bear a body.
    pub(super) fn stiff(place: Vector3, grip: Grip, number: u32) -> Self {
        Self::new(place, grip, number, SAG)
    }

    /// The same foot on a spring, which a body's weight on `number` of them compresses by `sag`, to its place.
    fn sprung(&self, number: u32, sag: f64) -> Self {
        Self::new(self.raised(-sag).place, self.grip, number, sag)
    }

    fn raised(&self, up: f64) -> Self {
        Self { place: self.place + Vector3::z() * up, ..*self }
    }
}

impl Grip {
    /// Forward and lateral speed of the rim or belt for a speed commanded to the drive.
    #[inline]
    pub(super) fn rim_speed(&self, drive: &PlanarTwist) -> Vector {
        match self {
            Self::Driven(axle) | Self::Rolling(axle) | Self::Roller(axle, _) => {
                Vector::new(drive.forward - drive.angular * axle.y, drive.left + drive.angular * axle.x)
            }
            Self::Body | Self::Free => Vector::zeros(),
        }
    }
}

/// Points of the rim of one of `number` wheels that may touch the ground.
fn wheel(axle: Vector, radius: f64, grip: Grip, number: u32) -> impl Iterator<Item = Foot> {
    RIM.into_iter().map(move |degrees| {
        let (sin, cos) = math::sin_cos(units::from_deg(degrees));
        let place = Vector3::new(axle.x + radius * sin, axle.y, radius * (1.0 - cos));
        Foot::stiff(place, grip, number)
    })
}

/// Points of belts that may touch the ground: below, and on the rise towards the wheels at their ends.
fn belts(feet: &mut Vec<Foot>, drive: Tracked, radius: f64) {
    let half = 0.5 * drive.equivalent().track;
    for side in [1.0, -1.0] {
        // A belt's speed is that of the equivalent drive's wheel.
        let grip = Grip::Driven(Vector::new(0.0, side * half));
        let below: Vec<_> = drive.places(side).map(|place| Vector3::new(place.x, place.y, 0.0)).collect();
        let number = 2 * below.len() as u32;
        let rubber = |place| Foot::stiff(place, grip, number).sprung(number, BELT_SAG);
        feet.extend(below.into_iter().map(rubber));
        for end in [0.5, -0.5] {
            for degrees in [30.0, 60.0, 90.0] {
                let (sin, cos) = math::sin_cos(units::from_deg(degrees));
                let x = end * drive.length + end.signum() * radius * sin;
                let place = Vector3::new(x, side * 0.5 * drive.track, radius * (1.0 - cos));
                feet.push(Foot::stiff(place, grip, number));
            }
        }
    }
}

/// Centre of mass stated in a description, relative to the origin of the robot's model.
fn stated_centre(spec: &RobotSpec) -> Option<Vector3> {
    let ([x, y, z], [ahead, up]) = (spec.body.mass_centre.map(|c| c * spec.body.scale), spec.body.axle);
    let centre = Vector3::new(x - ahead, y, z - up + 0.5 * wheel_diameter(spec));
    (spec.body.mass_centre != [0.0; 3] && centre.z > 0.0).then_some(centre)
}

/// Ends of the outline along x.
fn ends(footprint: &Footprint) -> (f64, f64) {
    match footprint {
        Footprint::Disc { radius } => (-radius, *radius),
        Footprint::Rectangle(rectangle) => (rectangle.min.x, rectangle.max.x),
    }
}

/// Corners of the outline, at its top and at the axle's height, and the belly at half that height.
fn chassis(spec: &RobotSpec, belly: f64) -> Vec<Foot> {
    let axle = (0.5 * wheel_diameter(spec)).min(0.5 * spec.height);
    let outline: Vec<Vector> = match spec.footprint {
        Footprint::Disc { radius } => {
            (0..8).map(|eighth| direction(FRAC_PI_4 * f64::from(eighth)) * radius).collect()
        }
        Footprint::Rectangle(b) => [b.min.x, b.max.x]
            .into_iter()
            .flat_map(|x| [b.min.y, b.max.y].map(|y| Vector::new(x, y)))
            .collect(),
    };
    let corners = [axle, spec.height]
        .into_iter()
        .flat_map(|height| outline.iter().map(move |corner| Vector3::new(corner.x, corner.y, height)));
    let belly = [Vector3::new(belly, 0.0, 0.5 * axle)];
    corners.chain(belly).map(|place| Foot::stiff(place, Grip::Body, CORNERS)).collect()
}

fn wheel_diameter(spec: &RobotSpec) -> f64 {
    match spec.drive {
        DriveSpec::Differential { wheel_diameter, .. }
        | DriveSpec::Ackermann { wheel_diameter, .. }
        | DriveSpec::Tracked { wheel_diameter, .. }
        | DriveSpec::Omni { wheel_diameter, .. } => wheel_diameter,
        DriveSpec::Craft(_) => 0.0,
    }
}

/// Square of the mean radius of gyration of a block of the robot's size.
fn gyration(spec: &RobotSpec) -> f64 {
    let size = match spec.footprint {
        Footprint::Disc { radius } => Vector::new(1.7 * radius, 1.7 * radius),
        Footprint::Rectangle(rectangle) => rectangle.size(),
    };
    (2.0 / 36.0) * (size.norm_squared() + spec.height * spec.height)
}
