//! What cameras and lidars see of the files named in a script, wherever these are, and without them.

use std::path::Path;

use image::{Rgb, RgbImage};
use serde_json::Value;

use super::{Folder, python, report};

/// Takes an image, and reports the mean colour of its lowest rows and the number of red pixels.
const LOOK: &str = "from eye import *\nCAMInit(QQVGA)\nimage = CAMGet()\nbottom = image[-160 * 3 * 10:]\n\
                    mean = [sum(bottom[i::3]) // 1600 for i in range(3)]\n\
                    red = sum(r > 90 and g < 60 and b < 60 for r, g, b in zip(image[0::3], image[1::3], image[2::3]))\n\
                    LCDPrintf('%d %d %d %d', *mean, red)\n";

fn run(script: &Path) -> Value {
    report(&[script.to_str().unwrap()])
}

fn numbers(report: &Value) -> Vec<i32> {
    let text = report["robots"][0]["lcd_text"].as_str().unwrap_or_default();
    text.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

fn warnings(report: &Value) -> Vec<&str> {
    let list = report["warnings"].as_array();
    list.into_iter().flatten().map(|warning| warning.as_str().unwrap()).collect()
}

/// Writes an image of one colour in a subfolder.
fn paint(folder: &Folder, file: &str, colour: [u8; 3]) {
    std::fs::create_dir_all(folder.0.join(file).parent().unwrap()).unwrap();
    RgbImage::from_pixel(32, 32, Rgb(colour)).save(folder.0.join(file)).unwrap();
}

fn write(folder: &Folder, file: &str, text: &str) -> std::path::PathBuf {
    std::fs::create_dir_all(folder.0.join(file).parent().unwrap()).unwrap();
    folder.write(file, text)
}

#[test]
fn a_floors_image_is_found_from_the_file_that_names_it() {
    if !python() {
        return;
    }
    for (place, ending) in [("worlds/texture", "png"), ("worlds/texture", "jpg"), ("worlds/small", "bmp")] {
        let folder = Folder::new(&format!("floor-{ending}"));
        paint(&folder, &format!("{place}/Blue.{ending}"), [20, 40, 200]);
        write(
            &folder,
            "worlds/small/pool.wld",
            &format!("floor 4000 4000\nfloor_texture ../texture/blue.{ending}\n"),
        );
        write(&folder, "examples/one/look.py", LOOK);
        let script = write(
            &folder,
            "examples/one/look.sim",
            "world ../../worlds/small/pool.wld\nS4 2000 2000 0 look.py\n",
        );
        let all = run(&script);
        let [red, green, blue, _] = numbers(&all)[..] else { panic!("{all}") };
        assert!(red < 40 && green < 60 && blue > 150, "{ending}: {all}");
        assert!(warnings(&all).is_empty(), "{all}");
    }
}

#[test]
fn without_its_image_a_floor_is_gray_and_somebody_says_so() {
    if !python() {
        return;
    }
    let folder = Folder::new("floor-missing");
    write(&folder, "a.wld", "floor 4000 4000\nfloor_texture ../texture/nowhere.png\n");
    write(&folder, "broken.png", "no image");
    write(&folder, "b.wld", "floor 4000 4000\nfloor_texture broken.png\n");
    write(&folder, "look.py", LOOK);
    for (world, said) in
        [("a.wld", "`../texture/nowhere.png`, which does not exist"), ("b.wld", "a broken image")]
    {
        let all = run(&folder.write("look.sim", &format!("world {world}\nS4 2000 2000 0 look.py\n")));
        let [red, green, blue, _] = numbers(&all)[..] else { panic!("{all}") };
        assert!(red.abs_diff(green) < 12 && red.abs_diff(blue) < 16 && (100..220).contains(&red), "{all}");
        let [warning] = warnings(&all)[..] else { panic!("{all}") };
        assert!(warning.contains(said) && warning.ends_with("the floor is gray"), "{warning}");
    }
}

#[test]
fn a_robot_of_a_file_is_seen_as_its_model_says() {
    if !python() {
        return;
    }
    let folder = Folder::new("model");
    write(&folder, "robots/cart.robi", "drive DIFFERENTIAL_DRIVE\nwheel 54 3600 1100 45\nmodel cart.obj\n");
    write(&folder, "look.py", LOOK);
    let script =
        folder.write("look.sim", "robot ../robots/cart.robi\nS4 500 1000 0 look.py\ncart 1000 1000 0\n");
    let outline = run(&script);
    assert_eq!(numbers(&outline)[3], 0, "{outline}");
    let [warning] = warnings(&outline)[..] else { panic!("{outline}") };
    assert!(warning.contains("cart.robi:3:7: found `cart.obj`, which does not exist"), "{warning}");
    // A red plate across the robot's way, 200 mm wide and 300 mm high.
    write(&folder, "robots/cart.mtl", "newmtl red\nKd 0.9 0 0\n");
    let plate = "mtllib cart.mtl\nv -0.1 0 0\nv 0.1 0 0\nv 0.1 0.3 0\nv -0.1 0.3 0\nusemtl red\nf 1 2 3 4\n";
    write(&folder, "robots/cart.obj", plate);
    let seen = run(&script);
    assert!(warnings(&seen).is_empty(), "{seen}");
    assert!(numbers(&seen)[3] > 1000, "{seen}");
}

#[test]
fn a_sound_that_is_not_there_is_reported() {
    if !python() {
        return;
    }
    let folder = Folder::new("sound");
    write(&folder, "bell.wav", "a sound");
    let file = write(
        &folder,
        "play.py",
        "from eye import *\nfor name in 'BELL.wav', 'gong.wav':\n    AUPlay(name)\n",
    );
    let all = run(&file);
    assert_eq!(all["sounds"], 2, "{all}");
    let [warning] = warnings(&all)[..] else { panic!("{all}") };
    assert!(warning.ends_with("AUPlay: `gong.wav` does not exist"), "{warning}");
}

#[test]
fn a_sign_of_a_file_shows_its_picture() {
    if !python() {
        return;
    }
    let folder = Folder::new("sign");
    paint(&folder, "object/Sign/red.png", [230, 10, 10]);
    write(&folder, "object/Sign/sign.mtl", "newmtl face\nKd 1 1 1\nmap_Kd red.png\n");
    // A plate of 4 by 4 m that faces back, 8 m up, before scaling to 160 mm.
    let obj = "mtllib sign.mtl\nv -2 8 0\nv 2 8 0\nv 2 12 0\nv -2 12 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
               usemtl face\nf 1/1 2/2 3/3 4/4\n";
    write(&folder, "object/Sign/Sign.obj", obj);
    write(
        &folder,
        "object/Sign/sign.esObj",
        "obj sign.obj\nname Halt\nscale 0.04\ncapsule 0 6000 0 150 12000 y\n",
    );
    write(&folder, "look.py", LOOK);
    let script = |object: &str| {
        folder.write(
            "look.sim",
            &format!("object ../objects/Sign/sign.esObj\n{object}\nS4 500 1000 0 look.py\n"),
        )
    };
    let seen = run(&script("Halt 1500 1000 0"));
    assert!(warnings(&seen).is_empty(), "{seen}");
    assert!(numbers(&seen)[3] > 100, "{seen}");
    assert_eq!(numbers(&run(&script("Halt 300 1000 0")))[3], 0, "behind the robot");
    // Built-in objects need no file.
    let stop = run(&script("StopSign 1500 1000 0"));
    assert!(numbers(&stop)[3] > 100, "{stop}");
}

#[test]
fn cones_stand_where_a_script_puts_them_by_name() {
    if !python() {
        return;
    }
    let folder = Folder::new("cones");
    folder.write(
        "count.py",
        "from eye import *\nLIDARSet(180, 0, 180)\nscan = LIDARGet()\nhits = [d < 9000 for d in scan]\n\
         cones = sum(b and not a for a, b in zip([False] + hits, hits))\n\
         LCDPrintf('%d %d %d', SIMGetObjectCount(), cones, min(scan))\n",
    );
    let script = folder.write(
        "sae.sim",
        "world field2.wld\nrobot \"../../robots/Ackermann/SAE.robi\"\nSAE 4000 1200 90 count.py\n\
         object \"../../objects/ConeOrange/coneorange.esObj\"\nCone-O 4000 6500 0\nCone-O 3000 6100 0\nCone-O 5000 6100 0\n",
    );
    let all = run(&script);
    let [objects, cones, nearest] = numbers(&all)[..] else { panic!("{all}") };
    assert_eq!((objects, cones), (3, 3), "{all}");
    // The lidar is 2.25 m in front of the car's middle.
    assert!((2500..3100).contains(&nearest), "{all}");
    assert_eq!(warnings(&all).len(), 3, "what is built in takes the place of three files: {all}");
}

#[test]
fn a_name_of_the_script_gets_the_stand_in_of_the_missing_file() {
    if !python() {
        return;
    }
    let folder = Folder::new("stand-in");
    folder.write(
        "count.py",
        "from eye import *\nLCDPrintf('%d %d', SIMGetObjectCount(), SIMGetRobotCount())\n",
    );
    let script = folder.write(
        "odd.sim",
        "object ../a/beacon-7.esObj\nrobot ../b/walker.robi\nBeacon 500 1500 0\nBeacon 900 1500 0\nW1 500 500 0 count.py\n",
    );
    let all = run(&script);
    assert_eq!(numbers(&all), [2, 1], "{all}");
}

#[test]
fn who_polls_the_camera_gets_thirty_images_a_second() {
    if !python() {
        return;
    }
    let folder = Folder::new("polled");
    // Everything but the image is free, so it is polled as often as calls allow.
    folder.write(
        "poll.py",
        "from eye import *\nVWSetSpeed(0, 50)\nCAMInit(QQVGA)\nimages = []\n\
         while OSGetCount() < 2000:\n    images.append(bytes(CAMGet()))\n\
         LCDPrintf('%d', 1 + sum(a != b for a, b in zip(images, images[1:])))\n",
    );
    let script = folder.write("poll.sim", "can 900 500 0\nS4 500 500 0 poll.py\n");
    let all = run(&script);
    assert!((50..=61).contains(&numbers(&all)[0]), "{all}");
}

/// The chain of section 5.3: the followers' tilted lidars look over each other and see the leader's handle.
#[test]
fn a_chain_follows_the_leaders_handle() {
    if !python() {
        return;
    }
    let folder = Folder::new("chain");
    folder.write(
        "lidarbot.robi",
        "drive DIFFERENTIAL_DRIVE\nname LidarBot\nwheel 54 3600 1100 45\noutline disc 60 90\n\
         lidar 0 0 100 0 0 0 180 10 180\npsd 1 PSD_FRONT 0 60 30 0 0 0\npsd 2 PSD_LEFT 45 60 30 0 0 -90\n\
         psd 3 PSD_RIGHT -45 60 30 0 0 90\n",
    );
    folder.write("lead.py", "from eye import *\nVWSetSpeed(200, 0)\nOSWait(14000)\nVWSetSpeed(0, 0)\n");
    folder.write(
        "follow.py",
        "from eye import *\nseen = 0\nwhile OSGetCount() < 14000:\n    scan = list(LIDARGet())\n    nearest = min(scan)\n\
         \x20   seen += nearest < 9000\n    turn = 90 - scan.index(nearest) if nearest < 9000 else 0\n\
         \x20   VWSetSpeed(0 if PSDGet(1) < 250 else 250, turn)\n    OSWait(100)\nVWSetSpeed(0, 0)\n\
         x, y, z, phi = (n.value for n in SIMGetRobot(0))\na, b, z, phi = (n.value for n in SIMGetRobot(1))\n\
         LCDPrintf('%d %d', ((x - a) ** 2 + (y - b) ** 2) ** 0.5, seen)\n",
    );
    let script = folder.write(
        "chain.sim",
        "world field.wld\nrobot lidarbot.robi\nLabbot 2500 1200 0 lead.py\nLIDARBOT 1500 1500 0 follow.py\n\
         LIDARBOT 1500 900 0 follow.py\nLIDARBOT 900 1300 0 follow.py\n",
    );
    let all = run(&script);
    for robot in &all["robots"].as_array().unwrap()[1..] {
        let told: Vec<i32> =
            robot["lcd_text"].as_str().unwrap().split_whitespace().map(|n| n.parse().unwrap()).collect();
        assert!(told[0] < 1200 && told[1] > 100, "{robot}");
    }
    assert!(all["robots"][0]["path_length_mm"].as_f64().unwrap() > 2500.0, "{all}");
}
