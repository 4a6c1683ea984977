use image::{GrayImage, Luma, Rgb};
use proptest::prelude::*;

use super::*;
use crate::io::{FontFamily, FontStyle};

/// Bounding box of all pixels of a colour: left, top, right, bottom.
fn bounds(lcd: &Lcd, colour: [u8; 3]) -> Option<(u32, u32, u32, u32)> {
    lcd.frame().enumerate_pixels().filter(|(.., p)| p.0 == colour).fold(None, |b, (x, y, _)| match b {
        None => Some((x, y, x, y)),
        Some((l, t, r, d)) => Some((l.min(x), t.min(y), r.max(x), d.max(y))),
    })
}

/// A coordinate: ordinary, far out, or extreme.
fn wild() -> impl Strategy<Value = i32> {
    prop_oneof![-50..550i32, -20_000..20_000i32, any::<i32>(), Just(i32::MAX), Just(i32::MIN)]
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn nothing_panics_wherever_it_is_drawn(
        a in (wild(), wild()), b in (wild(), wild()), size in wild(), solid: bool, text in ".{0,60}",
    ) {
        let mut lcd = Lcd::new();
        let fill = if solid { Fill::Solid } else { Fill::Outline };
        let image = GrayImage::new(7, 5);
        lcd.set_font(Font { size, ..Font::default() }).unwrap();
        lcd.set_pixel(a, Colour::RED).unwrap();
        lcd.pixel(b).unwrap();
        lcd.draw_line(a, b, Colour::RED).unwrap();
        lcd.draw_rectangle(a, b, Colour::RED, fill).unwrap();
        lcd.draw_circle(a, size, Colour::RED, fill).unwrap();
        lcd.draw_image((&image).into(), Viewport::new(a, b.0, b.1)).unwrap();
        lcd.print_at(a.0, b.1, &text).unwrap();
        lcd.set_menu_label(Key::Key2, &text, Colour::RED, Colour::BLUE).unwrap();
        lcd.print_at(b.0, a.1, "a\n\tb\r\u{7}").unwrap();
    }

    #[test]
    fn the_cursor_stays_where_text_can_be_read(text in "[ -~\n\t]{0,3000}", size in 8..25i32) {
        let mut lcd = Lcd::new();
        lcd.set_font(Font { size, ..Font::default() }).unwrap();
        lcd.print(&text).unwrap();
        let (rows, columns) = lcd.text_size();
        let (row, column) = lcd.cursor().unwrap();
        prop_assert!((0..rows).contains(&row) && (0..=columns).contains(&column));
    }
}

#[test]
fn text_wraps_and_scrolls() {
    let mut lcd = Lcd::new();
    assert_eq!(lcd.text_size(), (24, 80));
    lcd.print(&"x".repeat(80)).unwrap();
    assert_eq!(lcd.cursor().unwrap(), (0, 80));
    lcd.print("\n").unwrap();
    assert_eq!(lcd.cursor().unwrap(), (1, 0));
    lcd.print(&"y".repeat(81)).unwrap();
    assert_eq!(lcd.cursor().unwrap(), (2, 1));

    let mut scrolled = Lcd::new();
    (0..30).for_each(|i| scrolled.print(&format!("line {i}\n")).unwrap());
    let mut direct = Lcd::new();
    (0..23).for_each(|row| direct.print_at(row, 0, &format!("line {}", row + 7)).unwrap());
    assert_eq!(scrolled.frame(), direct.frame());
    assert_eq!(scrolled.cursor().unwrap(), (23, 0));
}

#[test]
fn without_scrolling_the_rest_is_lost() {
    let mut lcd = Lcd::new();
    lcd.set_display_option(DisplayOption::Scrolling, false).unwrap();
    lcd.print(&"\n".repeat(23)).unwrap();
    lcd.print("last").unwrap();
    let before = lcd.frame().clone();
    lcd.print("\nlost").unwrap();
    assert_eq!(lcd.frame(), &before);
    assert_eq!(lcd.cursor().unwrap(), (24, 4));
}

#[test]
fn without_line_feed_a_newline_goes_straight_down() {
    let mut lcd = Lcd::new();
    lcd.set_display_option(DisplayOption::LineFeed, false).unwrap();
    lcd.print("abc\nd").unwrap();
    assert_eq!(lcd.cursor().unwrap(), (1, 4));
}

#[test]
fn rows_18_to_20_fit_between_a_qvga_image_and_the_menu() {
    let mut lcd = Lcd::new();
    lcd.set_menu(["", "", "", "END"]).unwrap();
    lcd.set_text_colours(Colour::GREEN, Colour::RED).unwrap();
    (18..=20).for_each(|row| lcd.print_at(row, 0, "M").unwrap());
    let (_, top, _, bottom) = bounds(&lcd, [255, 0, 0]).unwrap();
    assert!(top >= 240 && bottom < Lcd::HEIGHT - Lcd::MENU_HEIGHT, "{top} {bottom}");
    assert_eq!(lcd.text_size().0, 21);
}

#[test]
fn without_auto_refresh_drawing_waits_for_refresh() {
    let mut lcd = Lcd::new();
    lcd.set_display_option(DisplayOption::AutoRefresh, false).unwrap();
    lcd.set_pixel((3, 4), Colour::RED).unwrap();
    assert_eq!(lcd.pixel((3, 4)).unwrap(), Some(Colour::RED));
    assert_eq!(lcd.screenshot().unwrap().get_pixel(3, 4).0, [0; 3]);
    // Switching off what is already off does not refresh.
    lcd.set_display_option(DisplayOption::AutoRefresh, false).unwrap();
    assert_eq!(lcd.frame().get_pixel(3, 4).0, [0; 3]);
    lcd.refresh().unwrap();
    assert_eq!(lcd.frame().get_pixel(3, 4).0, [255, 0, 0]);
    lcd.set_pixel((5, 4), Colour::BLUE).unwrap();
    lcd.set_display_option(DisplayOption::AutoRefresh, true).unwrap();
    assert_eq!(lcd.frame().get_pixel(5, 4).0, [0, 0, 255]);
    lcd.set_pixel((6, 4), Colour::BLUE).unwrap();
    assert_eq!(lcd.frame().get_pixel(6, 4).0, [0, 0, 255]);
}

#[test]
fn a_binary_image_shows_zero_as_white() {
    let mut lcd = Lcd::new();
    let image = GrayImage::from_fn(2, 1, |x, _| Luma([x as u8]));
    lcd.draw_image(DisplayImage::Binary(&image), Viewport::new((0, 0), 2, 1)).unwrap();
    assert_eq!(lcd.pixel((0, 0)).unwrap(), Some(Colour::WHITE));
    assert_eq!(lcd.pixel((1, 0)).unwrap(), Some(Colour::BLACK));
}

#[test]
fn the_default_window_is_qvga_at_the_origin() {
    let mut lcd = Lcd::new();
    let image = RgbImage::from_pixel(160, 120, Rgb([9, 8, 7]));
    lcd.draw_image((&image).into(), Viewport::default()).unwrap();
    assert_eq!(bounds(&lcd, [9, 8, 7]), Some((0, 0, 319, 239)));
}

#[test]
fn an_empty_image_draws_nothing() {
    let mut lcd = Lcd::new();
    let image = RgbImage::new(0, 0);
    lcd.draw_image((&image).into(), Viewport::default()).unwrap();
    assert_eq!(lcd.frame(), Lcd::new().frame());
}

#[test]
fn the_menu_survives_clearing_and_goes_when_switched_off() {
    let mut lcd = Lcd::new();
    lcd.set_menu_label(Key::Key3, "GO", Colour::BLACK, Colour::GREEN).unwrap();
    let label = bounds(&lcd, [0, 255, 0]).unwrap();
    assert_eq!(label, (241, 283, 359, 319));
    lcd.print("text").unwrap();
    lcd.clear_display().unwrap();
    assert_eq!(bounds(&lcd, [0, 255, 0]), Some(label));
    assert_eq!(lcd.cursor().unwrap(), (0, 0));
    lcd.set_display_option(DisplayOption::Menu, false).unwrap();
    assert_eq!(lcd.frame(), Lcd::new().frame());
}

#[test]
fn text_can_be_transparent_and_inverted() {
    let mut lcd = Lcd::new();
    lcd.set_text_colours(Colour::RED, Colour::BLACK).unwrap();
    lcd.set_display_option(DisplayOption::InvertedForeground, true).unwrap();
    lcd.set_display_option(DisplayOption::InvertedBackground, true).unwrap();
    lcd.print("x").unwrap();
    assert!(bounds(&lcd, [0, 255, 255]).is_some());
    assert_eq!(bounds(&lcd, [255; 3]), Some((0, 6, 5, 18)));

    let mut lcd = Lcd::new();
    lcd.draw_rectangle((0, 0), (50, 50), Colour::BLUE, Fill::Solid).unwrap();
    lcd.set_display_option(DisplayOption::TransparentText, true).unwrap();
    lcd.print("x").unwrap();
    assert_eq!(bounds(&lcd, [0; 3]), Some((0, 0, 479, 319)));
    assert_eq!(lcd.pixel((0, 6)).unwrap(), Some(Colour::BLUE));
}

#[test]
fn bold_and_large_text_differs() {
    let printed = |font| {
        let mut lcd = Lcd::new();
        lcd.set_font(font).unwrap();
        lcd.print("Ab").unwrap();
        lcd.frame().clone()
    };
    let normal = printed(Font::default());
    assert_eq!(normal, printed(Font { size: 12, family: FontFamily::Courier, ..Font::default() }));
    assert_ne!(normal, printed(Font { style: FontStyle::Bold, ..Font::default() }));
    assert_ne!(normal, printed(Font { style: FontStyle::Italic, ..Font::default() }));
    assert_ne!(normal, printed(Font { size: 24, ..Font::default() }));
}
