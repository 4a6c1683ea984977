//! Traffic signs (book, section 13.5): learns what two signs look like, a red square with a bar and a blue
//! disc, and finds them in pictures that it has not seen.
//!
//! `cargo run --release --example signs`

use roverlab::random::Stream;
use roverlab::vision::RgbView;
use roverlab::vision::signs::{Area, SignFinder, SignTrainer};

const WIDTH: usize = 160;
const HEIGHT: usize = 120;

/// A noisy picture with a sign.
fn picture(class: usize, sign: Area, stream: &mut Stream) -> Vec<u8> {
    let mut pixels = Vec::new();
    for i in 0..WIDTH * HEIGHT {
        let x = ((i % WIDTH) as f64 - sign.left) / sign.width;
        let y = ((i / WIDTH) as f64 - sign.top) / sign.height;
        let inside = (0.0..1.0).contains(&x) && (0.0..1.0).contains(&y);
        let gray = 90 + stream.below(50) as u8;
        pixels.extend(match class {
            0 if inside && (0.4..0.6).contains(&y) => [240; 3],
            0 if inside => [190, 30, 40],
            1 if (x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5) < 0.25 => [30, 60, 180],
            _ => [gray; 3],
        });
    }
    pixels
}

fn somewhere(stream: &mut Stream) -> Area {
    let side = stream.between(22.0, 60.0);
    let left = stream.between(0.0, WIDTH as f64 - side);
    Area::new(left, stream.between(0.0, HEIGHT as f64 - side), side, side)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut stream = Stream::new(1);
    let mut trainer = SignTrainer::new(["bar", "disc"])?;
    for class in [0, 1].repeat(15) {
        let area = somewhere(&mut stream);
        let pixels = picture(class, area, &mut stream);
        trainer.add(RgbView::new(&pixels, WIDTH, HEIGHT)?, &[(class, area)])?;
    }
    let mut finder = SignFinder::new(trainer.finder(1)?);
    let mut right = 0;
    for class in [0, 1].repeat(10) {
        let area = somewhere(&mut stream);
        let pixels = picture(class, area, &mut stream);
        for found in finder.find(RgbView::new(&pixels, WIDTH, HEIGHT)?)? {
            let name = &finder.model().names()[found.class];
            println!(
                "a {name} of {:.0} pixels at {:.0}, {:.0}",
                found.area.width, found.area.left, found.area.top
            );
            right += usize::from(found.class == class && found.area.overlap(&area) > 0.5);
        }
    }
    println!("{right} of 20 signs were found, and told right");
    assert!(right >= 19);
    Ok(())
}
