//! A new effect is one file and one entry of a list, whatever it acts on: four are added here, one for each action, and everything that knows the
//! catalogue knows them.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod heavy_cell;
mod lazy_gauge;
mod spring_beside;
mod swollen_net;

use bulge_effects::{Catalogue, Moment, Stage, describe, known};
use bulge_model::{Model, Record, Wanted};
use bulge_muscles::{Muscle, from_toml, preset};
use std::fs;
use std::path::{Path, PathBuf};

/// The list: all that is written besides the four files.
fn catalogue() -> Catalogue {
    let catalogue = Catalogue::builtin();
    let catalogue = catalogue.with(swollen_net::SwollenNet).unwrap();
    let catalogue = catalogue.with(lazy_gauge::LazyGauge).unwrap();
    let catalogue = catalogue.with(spring_beside::SpringBeside).unwrap();
    catalogue.with(heavy_cell::HeavyCell).unwrap()
}

const NEW: [(&str, Stage); 4] = [
    ("swollen-net", Stage::Shape),
    ("lazy-gauge", Stage::Input),
    ("spring-beside", Stage::Load),
    ("heavy-cell", Stage::Output),
];

fn record() -> Record {
    let at = |i: usize| Moment {
        begins: i.is_multiple_of(12),
        ..Moment::at_rest(1e5 * (1 + i / 12) as f64, 0.03 + 0.02 * (i % 12) as f64)
    };
    let moments: Vec<Moment> = (0..36).map(at).collect();
    Record::from_moments(moments, vec![0.0; 36], vec![0..12, 12..24, 24..36]).unwrap()
}

/// Cards, muscle files, forces and derivatives, without a word about the new effects anywhere else.
#[test]
fn new_effects_are_known_everywhere() {
    let (catalogue, muscle, record) = (catalogue(), preset("ppam-2-r16").unwrap(), record());
    for (name, stage) in NEW {
        let effect = catalogue.find(name).unwrap();
        assert_eq!(effect.stage(), stage);
        assert!(describe(effect.as_ref()).starts_with(&format!("{name}: ")));
        // In a muscle file.
        let key = effect.parameters()[0].key.to_owned();
        let value = if stage == Stage::Load { "50 N" } else { "3 %" };
        let text = format!("{}\n[effects.{name}]\n{key} = \"{value}\"\n", bulge_muscles::to_toml(&muscle));
        let stated: Muscle = from_toml(&text, "new.toml").unwrap();
        let theta = known(&stated, &catalogue).unwrap()[0].1.clone();
        // In a model: something changes, and the derivative is that of a difference.
        let model = Model::new(&muscle).with(effect, None).unwrap();
        let wanted = Wanted { parameters: vec![0], readings: false };
        let found = model.evaluate(&record, &theta, &wanted).unwrap();
        let force = |x: f64| model.evaluate(&record, &[x], &Wanted::default()).unwrap().force;
        let h = 1e-4 * theta[0];
        let (off, up, down) = (force(0.0), force(theta[0] + h), force(theta[0] - h));
        let largest = found.force.iter().zip(&off).map(|(on, off)| (on - off).abs()).fold(0.0, f64::max);
        assert!(largest > 5.0, "{name}: {largest}");
        for i in 0..record.len() {
            let difference = (up[i] - down[i]) / (2.0 * h);
            assert!((found.jacobian[i] / difference - 1.0).abs() < 1e-6, "{name} {i}: {difference}");
        }
    }
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.ends_with("target") {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// A source without its tests.
fn without_tests(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default().to_owned()
}

/// Which files name a type: an effect's own and the list, here and of every effect of the catalogue.
#[test]
fn an_effect_is_named_in_its_file_and_in_the_list() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut files = Vec::new();
    sources(&root.join("crates/effects/src"), &mut files);
    sources(&root.join("validation/tests/all"), &mut files);
    let texts: Vec<(PathBuf, String)> =
        files.into_iter().map(|path| (path.clone(), without_tests(&path))).collect();
    // By its path, as code names it: prose may use the word.
    let names = |text: &str, path: &str| {
        let is_whole = |at: usize| {
            !text[at + path.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':')
        };
        text.match_indices(path).any(|(at, _)| is_whole(at))
    };
    let mut seen = 0;
    for (own, text) in &texts {
        // `impl Effect for X {` at the beginning of a line: not in the example of a doc comment.
        for name in text.lines().filter_map(|line| line.strip_prefix("impl Effect for ")?.split(' ').next()) {
            if name == "UserEffect" {
                continue;
            }
            let module = own.file_stem().unwrap().to_string_lossy();
            let path = format!("{module}::{name}");
            let others: Vec<&PathBuf> = texts
                .iter()
                .filter(|(file, text)| file != own && names(text, &path))
                .map(|(file, _)| file)
                .collect();
            let entry = |path: &&PathBuf| path.ends_with("mod.rs") || path.ends_with("new_effect.rs");
            assert!(others.len() == 1 && others.iter().all(entry), "{name}: {others:?}");
            seen += 1;
        }
    }
    assert!(seen >= NEW.len() + 50, "{seen}");
}
