use std::fmt::Write;

use crate::geometry::{Pose, Twist};
use crate::io::{DisplayOption, Fill, Font, Key, LidarSettings, Pixel, Resolution, Viewport};
use crate::world::Colour;

/// A command given to a [`MockRobot`](super::MockRobot), with its arguments. Readings are not commands.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Call {
    /// `wait(seconds)`
    Wait(f64),
    /// `set_speed(twist)`
    SetSpeed(Twist),
    /// `set_pose(pose)`
    SetPose(Pose),
    /// `straight(distance, speed)`
    Straight(f64, f64),
    /// `turn(angle, speed)`
    Turn(f64, f64),
    /// `curve(length, angle, speed)`; `drive_to` appears as the curve that it drives.
    Curve(f64, f64, f64),
    /// `wait_done()`
    WaitDone,
    /// `configure_lidar(settings)`
    ConfigureLidar(LidarSettings),
    /// `set_resolution(resolution)`
    SetResolution(Resolution),
    /// `wait_key()`
    WaitKey,
    /// `send(to, data)`
    Send(u32, Vec<u8>),
    /// `set_motor(motor, fraction)`
    SetMotor(u8, f64),
    /// `set_servo(servo, position)`
    SetServo(u8, f64),
    /// `reset_encoder(motor)`
    ResetEncoder(u8),
    /// `print(text)`; `print_at` appears as `SetCursor` and `Print`.
    Print(String),
    /// `set_cursor(row, column)`
    SetCursor(i32, i32),
    /// `set_text_colours(foreground, background)`
    SetTextColours(Colour, Colour),
    /// `set_font(font)`
    SetFont(Font),
    /// `clear_display()`
    ClearDisplay,
    /// `set_pixel(at, colour)`
    SetPixel(Pixel, Colour),
    /// `draw_line(from, to, colour)`
    DrawLine(Pixel, Pixel, Colour),
    /// `draw_rectangle(corner, opposite, colour, fill)`
    DrawRectangle(Pixel, Pixel, Colour, Fill),
    /// `draw_circle(centre, diameter, colour, fill)`
    DrawCircle(Pixel, i32, Colour, Fill),
    /// `draw_image(picture, viewport)`: columns and rows of the picture, and the viewport.
    DrawImage((u32, u32), Viewport),
    /// `set_menu_label(key, label, foreground, background)`
    SetMenuLabel(Key, String, Colour, Colour),
    /// `set_menu(labels)`
    SetMenu([String; 4]),
    /// `set_display_option(option, on)`
    SetDisplayOption(DisplayOption, bool),
    /// `refresh()`
    Refresh,
}

/// Expected and actual calls, one per line, with the first difference marked; `None` if they are equal.
pub(super) fn difference(expected: &[Call], actual: &[Call]) -> Option<String> {
    if expected == actual {
        return None;
    }
    let length = expected.len().max(actual.len());
    let first = (0..length).find(|&i| expected.get(i) != actual.get(i))?;
    let mut text = format!("the calls differ from number {} on", first + 1);
    for (title, calls) in [("expected", expected), ("actual", actual)] {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n{title}:");
        for (i, call) in calls.iter().enumerate() {
            let _ = write!(text, "\n{} {:3} {call:?}", if i == first { '>' } else { ' ' }, i + 1);
        }
        if calls.len() == first {
            text.push_str("\n>     (no more calls)");
        }
    }
    Some(text)
}
