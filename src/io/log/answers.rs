//! Code shared by the robots that answer from a recording.

use image::RgbImage;

use super::answer::Answers;
use super::open_loop::OpenLoop;
use super::parts::{ScanHead, Size};
use super::replay::Replay;
use super::values::{self, Put, Values};
use super::wire;
use crate::geometry::{Pose, Twist, Vector3};
use crate::io::{
    Attitude, Camera, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive, Encoders,
    Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres, Motors, Odometry, Pixel,
    Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::world::Colour;

/// The ranges or pixels of a recorded scan or image.
fn bulk_of(message: &[u8]) -> &[u8] {
    wire::bytes_of(message, 6).unwrap_or_default()
}

macro_rules! answered {
    ($robot:ident $capability:ident { $( fn $name:ident($($arg:ident: $type:ty),*) -> $result:ty; )* }) => {
        impl $capability for $robot {
            $( fn $name(&mut self $(, $arg: $type)*) -> Result<$result> {
                answered!(@body self $name($($arg),*))
            } )*
        }
    };
    (@body $self:ident scan_into($scan:ident)) => {
        $self.answer("scan_into", &Values::default(), |head, bulk| {
            let head: ScanHead = head.take()?;
            head.fill($scan, wire::doubles(bulk_of(bulk))?);
            Some(())
        })
    };
    (@body $self:ident image_into($image:ident)) => {
        $self.answer("image_into", &Values::default(), |size, bulk| {
            let Size(width, height) = size.take()?;
            let mut data = std::mem::take($image).into_raw();
            data.clear();
            data.extend_from_slice(bulk_of(bulk));
            *$image = values::image(width, height, data)?;
            Some(())
        })
    };
    (@body $self:ident $name:ident($($arg:ident),*)) => {{
        #[allow(unused_mut, reason = "some calls have no arguments")]
        let mut arguments = Values::default();
        $( $arg.put(&mut arguments); )*
        $self.answer(stringify!($name), &arguments, |result, _| result.take())
    }};
}

/// Implements every capability except the clock.
macro_rules! answering {
    ($($robot:ident),*) => { $(
        signatures! { Drive => answered!($robot) }
        signatures! { Odometry => answered!($robot) }
        signatures! { Manoeuvres => answered!($robot) }
        signatures! { StallDetector => answered!($robot) }
        signatures! { DistanceSensors => answered!($robot) }
        signatures! { Lidar => answered!($robot) }
        signatures! { Camera => answered!($robot) }
        signatures! { Display => answered!($robot) }
        signatures! { Keys => answered!($robot) }
        signatures! { Radio => answered!($robot) }
        signatures! { Motors => answered!($robot) }
        signatures! { Servos => answered!($robot) }
        signatures! { Encoders => answered!($robot) }
        signatures! { Inertial => answered!($robot) }
        signatures! { DepthSensor => answered!($robot) }
    )* };
}

answering! { Replay, OpenLoop }
