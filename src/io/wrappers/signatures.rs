/// Passes the methods of one capability to another macro, after a context to be passed through.
///
/// Methods implemented by others of their capability, such as `stop`, are not listed: their calls arrive as
/// those.
///
/// Arguments that are `Copy` or references are forwarded to the wrapped robot unchanged.
macro_rules! signatures {
    (Clock => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* Clock {
            fn now() -> f64;
            fn wait(seconds: f64) -> ();
        } }
    };
    (Drive => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* Drive {
            fn set_speed(twist: Twist) -> ();
        } }
    };
    (Odometry => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* Odometry {
            fn speed() -> Twist;
            fn pose() -> Pose;
            fn set_pose(pose: Pose) -> ();
        } }
    };
    (Manoeuvres => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* Manoeuvres {
            fn straight(distance: f64, speed: f64) -> ();
            fn turn(angle: f64, speed: f64) -> ();
            fn curve(length: f64, angle: f64, speed: f64) -> ();
            fn drive_to(forward: f64, left: f64, speed: f64) -> ();
            fn remaining() -> f64;
            fn is_done() -> bool;
            fn wait_done() -> ();
        } }
    };
    (StallDetector => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* StallDetector {
            fn is_stalled() -> bool;
        } }
    };
    (DistanceSensors => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* DistanceSensors {
            fn distance(sensor: Psd) -> f64;
        } }
    };
    (Lidar => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* Lidar {
            fn scan_into(scan: &mut LidarScan) -> ();
            fn configure_lidar(settings: LidarSettings) -> ();
        } }
    };
    (Camera => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* Camera {
            fn set_resolution(resolution: Resolution) -> ();
            fn resolution() -> Resolution;
            fn image_into(image: &mut RgbImage) -> ();
        } }
    };
    (Display => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* Display {
            fn print(text: &str) -> ();
            fn print_at(row: i32, column: i32, text: &str) -> ();
            fn set_cursor(row: i32, column: i32) -> ();
            fn cursor() -> (i32, i32);
            fn set_text_colours(foreground: Colour, background: Colour) -> ();
            fn set_font(font: Font) -> ();
            fn clear_display() -> ();
            fn display_size() -> (i32, i32);
            fn set_pixel(at: Pixel, colour: Colour) -> ();
            fn pixel(at: Pixel) -> Option<Colour>;
            fn draw_line(from: Pixel, to: Pixel, colour: Colour) -> ();
            fn draw_rectangle(corner: Pixel, opposite: Pixel, colour: Colour, fill: Fill) -> ();
            fn draw_circle(centre: Pixel, diameter: i32, colour: Colour, fill: Fill) -> ();
            fn draw_image(picture: DisplayImage<'_>, viewport: Viewport) -> ();
            fn set_menu_label(key: Key, label: &str, foreground: Colour, background: Colour) -> ();
            fn set_menu(labels: [&str; 4]) -> ();
            fn set_display_option(option: DisplayOption, on: bool) -> ();
            fn refresh() -> ();
            fn screenshot() -> RgbImage;
        } }
    };
    (Keys => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* Keys {
            fn read_key() -> Option<Key>;
            fn wait_key() -> Key;
            fn read_touch() -> Option<Pixel>;
        } }
    };
    (Radio => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* Radio {
            fn radio_id() -> u32;
            fn radio_peers() -> Vec<u32>;
            fn send(to: u32, data: &[u8]) -> ();
            fn receive() -> Option<RadioMessage>;
        } }
    };
    (Motors => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* Motors {
            fn set_motor(motor: u8, fraction: f64) -> ();
        } }
    };
    (Servos => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* Servos {
            fn set_servo(servo: u8, position: f64) -> ();
        } }
    };
    (Encoders => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* Encoders {
            fn encoder(motor: u8) -> i64;
            fn reset_encoder(motor: u8) -> ();
        } }
    };
    (DepthSensor => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* DepthSensor {
            fn depth() -> f64;
        } }
    };
    (Inertial => $then:ident!($($context:tt)*)) => {
        $then! { $($context)* Inertial {
            fn attitude() -> Attitude;
            fn turn_rates() -> Vector3;
            fn acceleration() -> Vector3;
        } }
    };
}

/// Implements capabilities for a wrapper: calls the wrapper's method `hook`, which may fail, then the wrapped
/// robot.
macro_rules! hooked {
    ($wrapper:ident, $hook:ident, $bounds:tt, $($capability:ident),+) => {
        $( signatures! { $capability => hooked_impl!($wrapper $hook $bounds) } )+
    };
}

macro_rules! hooked_impl {
    ($wrapper:ident $hook:ident [$($bound:ident)*] $capability:ident {
        $( fn $name:ident($($arg:ident: $type:ty),*) -> $result:ty; )*
    }) => {
        impl<R: $capability $(+ $bound)*> $capability for $wrapper<R> {
            $( fn $name(&mut self $(, $arg: $type)*) -> Result<$result> {
                self.$hook()?;
                self.inner.$name($($arg),*)
            } )*
        }
    };
}

pub(crate) use signatures;
