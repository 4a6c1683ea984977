use std::fmt::{Result, Write as _};

use super::super::esobj::model_place;
use super::super::lexer::{self, quote};
use super::super::number::{self, degrees, millimetres, undo_shift};
use super::read::DEFAULT_STEERING;
use crate::geometry::Aabb;
use crate::world::{
    CameraSpec, CarDynamics, Collider, DriveSpec, Footprint, InertialSpec, MotorSpec, PsdSpec, RobotSpec,
};

/// Writes a robot in a form that [`parse`](super::parse) reads back.
///
/// Sensors are written with the columns forward, left, up. A sensor whose side contradicts its name is read
/// back on the side of its name.
pub fn print(spec: &RobotSpec) -> String {
    lexer::written(|text| write_spec(text, spec))
}

fn write_spec(text: &mut String, spec: &RobotSpec) -> Result {
    let drive = match spec.drive {
        DriveSpec::Differential { .. } => "DIFFERENTIAL_DRIVE",
        DriveSpec::Ackermann { .. } => "ACKERMANN_DRIVE",
        DriveSpec::Tracked { .. } => "TRACKED_DRIVE",
        DriveSpec::Omni { .. } => "OMNI_DRIVE",
        // What tells boats from underwater craft stands in its lines.
        DriveSpec::Craft(_) => "AUV_DRIVE",
    };
    writeln!(text, "drive {drive}\nname {}", quote(&spec.name))?;
    write_model(text, spec)?;
    writeln!(text, "mass {} {}", number::print(spec.mass, 0), model_place(spec.body.mass_centre))?;
    if spec.friction != RobotSpec::DEFAULT_FRICTION {
        writeln!(text, "friction {}", number::print(spec.friction, 0))?;
    }
    write_drive(text, spec)?;
    write_solid(text, spec)?;
    write_mast(text, spec)?;
    write_motor(text, spec)?;
    spec.psds.iter().try_for_each(|psd| write_psd(text, psd, spec.body.axle[0]))?;
    write_lidar(text, spec)?;
    spec.camera.iter().try_for_each(|camera| write_camera(text, camera, spec.body.axle[0]))?;
    if let Some(sensor) = &spec.depth_sensor {
        writeln!(text, "depth_sensor {} {}", sensor.channel, millimetres(sensor.z))?;
    }
    if let Some(range) = spec.dvl {
        writeln!(text, "dvl {}", millimetres(range))?;
    }
    write_inertial(text, &spec.inertial)?;
    if spec.compass { writeln!(text, "compass") } else { Ok(()) }
}

fn write_inertial(text: &mut String, spec: &InertialSpec) -> Result {
    if *spec == InertialSpec::default() {
        return Ok(());
    }
    let groups = [spec.attitude, spec.turn_rates, spec.acceleration].map(Option::unwrap_or_default);
    writeln!(text, "inertial {}", groups.concat().iter().map(u8::to_string).collect::<Vec<_>>().join(" "))
}

fn write_model(text: &mut String, spec: &RobotSpec) -> Result {
    let Some(model) = &spec.model else { return Ok(()) };
    write!(text, "model {}", quote(&model.to_string_lossy()))?;
    let (offset, rotation) = (spec.body.model_offset, spec.body.model_rotation);
    if offset != [0.0; 3] || rotation != [0.0; 3] {
        write!(text, " {} {}", offset.map(millimetres).join(" "), rotation.map(degrees).join(" "))?;
    }
    writeln!(text)
}

fn write_drive(text: &mut String, spec: &RobotSpec) -> Result {
    let [ahead, up] = spec.body.axle.map(millimetres);
    let axles = |text: &mut String, wheelbase| {
        let turn = millimetres(undo_shift(wheelbase, spec.body.axle[0]));
        let turn_up = millimetres(spec.body.turn_axle_height);
        writeln!(text, "axel drive {up} {ahead}\naxel turn {turn_up} {turn}")
    };
    match spec.drive {
        DriveSpec::Craft(ref craft) => {
            writeln!(text, "axis {up} {ahead}")?;
            super::craft::write(text, craft)
        }
        DriveSpec::Differential { wheel_diameter, track, max_wheel_speed, ticks_per_turn } => {
            writeln!(text, "axis {up} {ahead}")?;
            write_wheel(text, "", [wheel_diameter, max_wheel_speed, ticks_per_turn, track])
        }
        DriveSpec::Tracked { wheel_diameter, track, length, width, max_wheel_speed, ticks_per_turn } => {
            writeln!(text, "axis {up} {ahead}\ntracks {} {}", millimetres(length), millimetres(width))?;
            write_wheel(text, "", [wheel_diameter, max_wheel_speed, ticks_per_turn, track])
        }
        DriveSpec::Omni { wheel_diameter, track, wheelbase, max_wheel_speed, ticks_per_turn } => {
            axles(text, wheelbase)?;
            write_wheel(text, "", [wheel_diameter, max_wheel_speed, ticks_per_turn, track])
        }
        DriveSpec::Ackermann {
            wheel_diameter,
            track,
            wheelbase,
            max_steering,
            max_wheel_speed,
            ticks_per_turn,
            dynamics,
        } => {
            axles(text, wheelbase)?;
            write_wheel(text, "drive ", [wheel_diameter, max_wheel_speed, ticks_per_turn, track])?;
            write_wheel(text, "turn ", [wheel_diameter, max_wheel_speed, ticks_per_turn, track])?;
            if max_steering != DEFAULT_STEERING {
                writeln!(text, "steering {}", degrees(max_steering))?;
            }
            dynamics.iter().try_for_each(|dynamics| write_dynamics(text, dynamics))
        }
    }
}

fn write_dynamics(text: &mut String, dynamics: &CarDynamics) -> Result {
    let [mass_centre, gyration, grip, brake] =
        [dynamics.mass_centre, dynamics.gyration, dynamics.grip, dynamics.brake].map(millimetres);
    let [stiffness, balance] = [dynamics.stiffness, dynamics.balance].map(|share| number::print(share, 0));
    let rate = degrees(dynamics.steering_rate);
    writeln!(text, "dynamics {mass_centre} {gyration} {grip} {stiffness} {balance} {brake} {rate}")
}

fn write_wheel(text: &mut String, which: &str, [diameter, speed, ticks, track]: [f64; 4]) -> Result {
    let (diameter, half) = (millimetres(diameter), millimetres(0.5 * track));
    writeln!(text, "wheel {which}{diameter} {} {} {half}", degrees(speed), number::print(ticks, 0))
}

fn write_solid(text: &mut String, spec: &RobotSpec) -> Result {
    let mut body = spec.body.clone();
    if body.colliders.is_empty() {
        body.colliders = vec![body.collider_of_footprint(&spec.footprint, spec.height)];
    }
    body.colliders.iter().try_for_each(|collider| write_collider(text, collider))?;
    let turns = matches!(spec.drive, DriveSpec::Differential { .. } | DriveSpec::Tracked { .. });
    if body
        .footprint(turns)
        .is_some_and(|(footprint, height)| footprint == spec.footprint && height == spec.height)
    {
        return Ok(());
    }
    let height = millimetres(spec.height);
    match &spec.footprint {
        Footprint::Disc { radius } => writeln!(text, "outline disc {} {height}", millimetres(*radius)),
        Footprint::Rectangle(b) => writeln!(text, "outline rectangle {} {height}", sides(b)),
    }
}

fn write_mast(text: &mut String, spec: &RobotSpec) -> Result {
    let Some(mast) = &spec.mast else { return Ok(()) };
    writeln!(text, "mast {} {}", sides(&mast.outline), millimetres(mast.top))
}

fn sides(rectangle: &Aabb) -> String {
    let (low, high) = (rectangle.min, rectangle.max);
    [low.x, low.y, high.x, high.y].map(millimetres).join(" ")
}

fn write_collider(text: &mut String, collider: &Collider) -> Result {
    match *collider {
        Collider::Box { size: [forward, left, up], centre } => {
            let size = [left, up, forward].map(millimetres).join(" ");
            writeln!(text, "collider box {size} {}", model_place(centre))
        }
        Collider::Sphere { radius, centre } => {
            writeln!(text, "collider sphere {} {}", millimetres(radius), model_place(centre))
        }
        // The format's capsules are upright.
        Collider::Capsule { radius, height, centre, .. } => {
            let size = [radius, height].map(millimetres).join(" ");
            writeln!(text, "collider capsule {size} {}", model_place(centre))
        }
    }
}

fn write_motor(text: &mut String, spec: &RobotSpec) -> Result {
    if spec.motor == MotorSpec::default() {
        return Ok(());
    }
    let lag = number::print(spec.motor.time_constant, 0);
    writeln!(text, "motor {lag} {}", millimetres(spec.motor.max_acceleration))
}

fn write_psd(text: &mut String, psd: &PsdSpec, ahead: f64) -> Result {
    let forward = undo_shift(psd.mount.x, ahead);
    let place = [forward, psd.mount.y, psd.mount.z].map(millimetres).join(" ");
    let (name, turns) = (quote(&psd.name), [psd.mount.pitch, psd.mount.yaw].map(degrees).join(" "));
    // A sensor beside the axle that faces forwards would be taken for one with the other columns; the older
    // form is unambiguous.
    if forward == 0.0 && psd.mount.y != 0.0 && psd.name.to_ascii_uppercase().contains("FRONT") {
        writeln!(text, "psd {name} {} {place} {turns} 0", psd.id)?;
    } else {
        writeln!(text, "psd {} {name} {place} {turns} 0", psd.id)?;
    }
    if psd.max_range == PsdSpec::DEFAULT_MAX_RANGE {
        return Ok(());
    }
    writeln!(text, "psd_range {}", millimetres(psd.max_range))
}

fn write_lidar(text: &mut String, spec: &RobotSpec) -> Result {
    let Some(lidar) = &spec.lidar else { return Ok(()) };
    let mount = &lidar.mount;
    let place = [undo_shift(mount.x, spec.body.axle[0]), mount.y, mount.z].map(millimetres).join(" ");
    let turns = [mount.pitch, mount.yaw, mount.roll].map(degrees).join(" ");
    let (range, tilt) = (degrees(lidar.field_of_view), degrees(lidar.tilt));
    writeln!(text, "lidar {place} {turns} {range} {tilt} {}", lidar.points)?;
    if lidar.max_range == PsdSpec::DEFAULT_MAX_RANGE {
        return Ok(());
    }
    writeln!(text, "lidar_range {}", millimetres(lidar.max_range))
}

fn write_camera(text: &mut String, camera: &CameraSpec, ahead: f64) -> Result {
    let mount = &camera.mount;
    let forward = undo_shift(mount.x, ahead);
    // At exactly 0, the second column would be taken for the first.
    let forward = if forward == 0.0 && mount.y != 0.0 { f64::MIN_POSITIVE } else { forward };
    let place = [forward, mount.y, mount.z].map(millimetres).join(" ");
    let angles = [mount.yaw, camera.tilt, camera.max_pan, camera.max_tilt].map(degrees).join(" ");
    writeln!(text, "camera {place} {angles}")?;
    let view = degrees(camera.field_of_view);
    if camera.fisheye {
        writeln!(text, "fisheye {view}")
    } else if camera.field_of_view != CameraSpec::DEFAULT_FIELD_OF_VIEW {
        writeln!(text, "camera_view {view}")
    } else {
        Ok(())
    }
}
