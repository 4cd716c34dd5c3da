//! A small campaign of straight lines, whose every value follows by hand.
//!
//! A channel of section `s` is `offset + slope * (x - 30 m)`, in kN; simulation and measurement
//! differ in the offset only.

use std::fmt::Write;
use std::fs;
use std::path::Path;

pub struct Section {
    pub name: &'static str,
    pub zone: u8,
    pub direction: &'static str,
    pub radius: &'static str,
    pub deficiency: f64,
    pub speed: f64,
    /// Measured offset of `Y_1R` and `Y_1L`, and how much larger the simulated ones are [kN].
    pub right: (f64, f64),
    pub left: (f64, f64),
}

/// Rise of every channel over the distance [kN/m].
pub const SLOPE: f64 = 0.01;
pub const START: f64 = 30.0;
pub const END: f64 = 150.0;

pub const SECTIONS: [Section; 4] = [
    Section {
        name: "S1",
        zone: 1,
        direction: "straight",
        radius: "",
        deficiency: 0.0,
        speed: 72.0,
        right: (1.0, 0.5),
        left: (-2.0, 0.25),
    },
    Section {
        name: "S2",
        zone: 2,
        direction: "right",
        radius: "500",
        deficiency: 100.0,
        speed: 72.0,
        right: (4.0, 1.0),
        left: (-20.0, 2.0),
    },
    Section {
        name: "S3",
        zone: 2,
        direction: "left",
        radius: "450",
        deficiency: 50.0,
        speed: 90.0,
        right: (22.0, -1.0),
        left: (-5.0, 0.5),
    },
    Section {
        name: "S4",
        zone: 2,
        direction: "right",
        radius: "400",
        deficiency: 80.0,
        speed: 90.0,
        right: (3.0, -2.0),
        left: (-25.0, -3.0),
    },
];

/// Records at 200 Hz and 20 m/s, 30 m more than the section at both ends.
pub fn write_campaign(folder: &Path) {
    let write = |name: &str, text: String| {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, text).expect("a file");
    };
    let paths = "vehicle: vehicle.yaml\nsections: sections.csv\nmeasurement: measurement\nsimulation: simulation\n";
    write("campaign.yaml", format!("name: straight lines\n{paths}sampling_rate [Hz]: 200\n"));
    write("vehicle.yaml", "name: none\ncategory: passenger\nQ0: 60\n".into());
    let mut table = "section,zone [-],start [m],end [m],radius [m],direction,cant [mm],cant deficiency [mm],speed [km/h]\n".to_string();
    for section in &SECTIONS {
        let Section { name, zone, direction, radius, deficiency, speed, .. } = section;
        writeln!(table, "{name},{zone},{START},{END},{radius},{direction},0,{deficiency},{speed}")
            .expect("a string");
        for (kind, more) in [("measurement", 0.0), ("simulation", 1.0)] {
            let mut record =
                "time [s],distance [m],Y_1R [kN],Y_1L [kN],Y_2R [kN],Y_2L [kN]\n".to_string();
            for sample in 0..=1800 {
                let (time, x) = (f64::from(sample) * 0.005, f64::from(sample) * 0.1);
                let rise = SLOPE * (x - START);
                let value = |(offset, difference): (f64, f64)| offset + more * difference + rise;
                writeln!(
                    record,
                    "{time},{x},{r},{l},{r},{l}",
                    r = value(section.right),
                    l = value(section.left)
                )
                .expect("a string");
            }
            write(&format!("{kind}/{name}.csv"), record);
        }
    }
    write("sections.csv", table);
}
