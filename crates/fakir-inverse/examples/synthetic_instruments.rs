//! Writes three synthetic measurements in the formats of different instruments to a folder, as examples for `fakir fit`. All are for the
//! paper's intermediate substrate, with a modulus of 1.4 MPa, and have normal noise:
//!
//! * `nanoindenter.txt`: a surface fraction of 0.01, loading to 2.4 um and back within 60 s, in nm and uN, with the contact point at 500 nm, a
//!   machine compliance of 2 mm/N, and a displacement drift of 60 nm in that time; noise 0.3 uN;
//! * `tester.csv`: a surface fraction of 0.01, loading through the transition to 3.4 um and unloading, in mm and mN with decimal commas, with the
//!   contact point at 12 um, a machine compliance of 2 mm/N, and a reading of 5 uN without any force; noise 0.5 uN;
//! * `microscope.csv`: a surface fraction of 0.05, forces up to 0.55 mN and contact radii in um; noise 0.3 um.
//!
//! `cargo run --example synthetic_instruments examples/fit`

use chacha20::ChaCha12Rng;
use chacha20::rand_core::SeedableRng;
use fakir::problem::Load;
use fakir::state::Run;
use fakir_case::{Case, CaseFile};
use rand_distr::{Distribution, Normal};
use std::error::Error;
use std::fmt::Write;
use std::path::Path;

const MACHINE_COMPLIANCE: f64 = 2e-3;

/// Draws of a normal distribution.
struct Noise {
    random: ChaCha12Rng,
    normal: Normal<f64>,
}

impl Noise {
    fn new(seed: u64, deviation: f64) -> Result<Self, Box<dyn Error>> {
        Ok(Self {
            random: ChaCha12Rng::seed_from_u64(seed),
            normal: Normal::new(0.0, deviation)?,
        })
    }

    fn next(&mut self) -> f64 {
        self.normal.sample(&mut self.random)
    }
}

fn case(surface_fraction: &str) -> Result<Case, Box<dyn Error>> {
    let mut file = CaseFile::parse("example", &Case::example().to_toml())?;
    file.set(&format!("pattern.surface_fraction={surface_fraction}"))?;
    file.set("substrate.young_modulus=1.4MPa")?;
    Ok(file.case()?)
}

/// Force (N) and contact radius (m) at an indentation.
fn contact(case: &Case, indentation: f64) -> Result<[f64; 2], Box<dyn Error>> {
    if indentation <= 0.0 {
        return Ok([0.0; 2]);
    }
    let load = Load::Indentation(indentation);
    let state = fakir::press(&case.system, load, case.method, &Run::default())?;
    Ok([state.force, state.contact_radius])
}

/// Indentations from 0.3 um before contact to the largest one, and back to the start.
fn there_and_back(deepest: f64, steps: u32) -> Vec<f64> {
    let at = |step: u32| -0.3e-6 + (deepest + 0.3e-6) * f64::from(step) / f64::from(steps);
    (0..=steps).chain((0..steps).rev()).map(at).collect()
}

fn nanoindenter() -> Result<String, Box<dyn Error>> {
    let case = case("0.01")?;
    let mut noise = Noise::new(11, 0.3e-6)?;
    let mut text = "Test 4 of batch 2\r\nSynthetic\tsynthetic_instruments.rs has the truth\r\nTip\tglass lens\r\n\r\n\
                    Depth (nm)\tLoad (uN)\tTime (s)\tLoad setpoint (V)\r\n"
        .to_owned();
    let indentations = there_and_back(2.4e-6, 24);
    for (number, indentation) in indentations.iter().enumerate() {
        let part = number as f64 / (indentations.len() - 1) as f64;
        let [force, _] = contact(&case, *indentation)?;
        let depth = indentation + 500e-9 + MACHINE_COMPLIANCE * force + 60e-9 * part;
        write!(
            text,
            "{:.2}\t{:.4}\t{:.2}\t{:.3}\r\n",
            depth * 1e9,
            (force + noise.next()) * 1e6,
            60.0 * part,
            0.01 * force * 1e6
        )?;
    }
    Ok(text)
}

fn tester() -> Result<String, Box<dyn Error>> {
    let case = case("0.01")?;
    let mut noise = Noise::new(12, 0.5e-6)?;
    let mut text = "\u{feff}\"Sample\";\"A 3\"\n\"Speed\";0,05;\"um/s\"\n\
                    \"Note\";\"synthetic: synthetic_instruments.rs has the truth\"\n\n\
                    Time;Crosshead;Standard force;Temperature\ns;mm;mN;\u{b0}C\n"
        .to_owned();
    let indentations = there_and_back(3.4e-6, 20);
    for (number, indentation) in indentations.iter().enumerate() {
        let [force, _] = contact(&case, *indentation)?;
        let reading = indentation + 12e-6 + MACHINE_COMPLIANCE * force;
        let line = format!(
            "{:.1};{:.7};{:.6};21.4\n",
            3.7 * number as f64,
            reading * 1e3,
            (force + 5e-6 + noise.next()) * 1e3
        );
        text += &line.replace('.', ",");
    }
    Ok(text)
}

fn microscope() -> Result<String, Box<dyn Error>> {
    let case = case("0.05")?;
    let mut noise = Noise::new(13, 0.3e-6)?;
    let mut text =
        "% Contact radii from images; synthetic: synthetic_instruments.rs has the truth\n\
                    Image, Force [mN], Contact radius [um]\n"
            .to_owned();
    for image in 1..=22 {
        let [force, radius] = contact(&case, 0.3e-6 * f64::from(image))?;
        writeln!(
            text,
            "{image}, {:.5}, {:.2}",
            force * 1e3,
            (radius + noise.next()) * 1e6
        )?;
    }
    Ok(text)
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("give the folder")?;
    let folder = Path::new(&folder);
    std::fs::write(folder.join("nanoindenter.txt"), nanoindenter()?)?;
    std::fs::write(folder.join("tester.csv"), tester()?)?;
    std::fs::write(folder.join("microscope.csv"), microscope()?)?;
    Ok(())
}
