//! The workbench as seen by a browser: over HTTP on this machine, compared with the answers of the library.

#![expect(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test that can't be set up fails"
)]

#[path = "../../cli/tests/program/schema.rs"]
mod schema;

use bulge_effects::{Catalogue, known};
use bulge_inference::{Options, Protocol, compare};
use bulge_measurements::Data;
use bulge_muscles::{Muscle, Quantity, from_toml};
use bulge_workbench::{Choices, DataFile, MuscleFile, Start, serve};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::sync::{Arc, mpsc};
use std::thread;
use tempfile::TempDir;

const MUSCLE: &str = include_str!("../../cli/data/braid.toml");
const DATA: &str = include_str!("../../cli/data/braid-loops.csv");

/// A running workbench.
struct Page {
    host: String,
    token: String,
}

/// The response to a request.
struct Answer {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Answer {
    fn json(&self) -> Value {
        serde_json::from_slice(&self.body)
            .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&self.body)))
    }

    /// The part of the page and the sentence of a refusal.
    fn refusal(&self) -> (String, String) {
        assert_eq!(self.status, 422, "{}", String::from_utf8_lossy(&self.body));
        let text = |name: &str| self.json()[name].as_str().unwrap().to_owned();
        (text("where"), text("error"))
    }
}

fn tour(folder: &Path) -> Choices {
    let path = folder.join("loops.csv");
    std::fs::write(&path, DATA).unwrap();
    Choices {
        data: vec![DataFile { name: "loops.csv".to_owned(), path }],
        columns: None,
        muscle: MuscleFile { toml: MUSCLE.to_owned(), origin: Some("braid.toml".to_owned()) },
        effects: Vec::new(),
        own_effects: None,
        excluded: Vec::new(),
    }
}

impl Page {
    fn open(choices: Choices, session: Option<PathBuf>, is_stated: bool) -> Self {
        let (told, address) = mpsc::channel();
        thread::spawn(move || {
            let start = Start { choices, is_stated, port: 0, session };
            serve(start, |address| told.send(address.to_owned()).unwrap()).unwrap();
        });
        let address = address.recv().expect("the server starts");
        let (host, token) =
            address.trim_start_matches("http://").trim_end_matches('/').split_once('/').unwrap();
        Self { host: host.to_owned(), token: token.to_owned() }
    }

    /// Sends a request as given; returns the whole response.
    fn send(&self, head: &str, body: &[u8]) -> Answer {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.write_all(head.as_bytes()).unwrap();
        // A server that refuses may close the connection before it has read everything.
        let _ = stream.write_all(body);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let end = answer.windows(4).position(|window| window == b"\r\n\r\n").expect("a head") + 4;
        let head = String::from_utf8_lossy(&answer[..end]).into_owned();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        let body = if head.contains("transfer-encoding: chunked") {
            unchunked(&answer[end..])
        } else {
            answer[end..].to_vec()
        };
        Answer { status, head, body }
    }

    fn ask(&self, method: &str, call: &str, body: &[u8]) -> Answer {
        let (host, token, length) = (&self.host, &self.token, body.len());
        let head = format!(
            "{method} /{token}/{call} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\nContent-Length: {length}\r\n\r\n"
        );
        self.send(&head, body)
    }

    fn get(&self, call: &str) -> Answer {
        self.ask("GET", &format!("api/{call}"), b"")
    }

    fn put(&self, change: &Value) -> Answer {
        self.ask("PUT", "api/session", change.to_string().as_bytes())
    }

    fn errors(&self) -> Vec<f64> {
        let comparison = self.get("comparison?held_out=0").json();
        comparison["ladder"].as_array().unwrap().iter().map(|rung| rung["rmse_n"].as_f64().unwrap()).collect()
    }
}

fn unchunked(mut rest: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    while let Some(end) = rest.windows(2).position(|window| window == b"\r\n") {
        let size = usize::from_str_radix(std::str::from_utf8(&rest[..end]).unwrap().trim(), 16).unwrap();
        body.extend_from_slice(&rest[end + 2..end + 2 + size]);
        rest = rest.get(end + size + 4..).unwrap_or_default();
    }
    body
}

fn effects(names: &[&str]) -> Value {
    json!({"effects": names.iter().map(|name| json!({"name": name})).collect::<Vec<_>>()})
}

fn opened() -> (TempDir, Page) {
    let folder = tempfile::tempdir().unwrap();
    let page = Page::open(tour(folder.path()), None, true);
    (folder, page)
}

/// The page gets the same bytes that `bulge compare --json` writes.
#[test]
fn the_documents_are_those_of_the_library() {
    let (_folder, page) = opened();
    assert_eq!(page.put(&effects(&["end-taper", "coulomb-friction"])).status, 200);
    let muscle = from_toml(MUSCLE, "m").unwrap();
    let data = Data::from_csv(DATA, "loops.csv").unwrap();
    let catalogue = Catalogue::builtin();
    let chosen = ["end-taper", "coulomb-friction"].map(|name| Arc::clone(catalogue.find(name).unwrap()));
    let expected = compare(&data, &muscle, &Options::new(catalogue, chosen.to_vec())).unwrap();
    let found = page.get("comparison");
    assert!(found.body == serde_json::to_vec(&expected).unwrap(), "the bytes differ");
    let found = found.json();
    // Without held-out errors everything else is unchanged.
    let quick = page.get("comparison?held_out=0").json();
    assert_eq!(quick["ladder"][2]["rmse_n"], found["ladder"][2]["rmse_n"]);
    assert!(
        quick["ladder"][2]["held_out_rmse_n"].is_null() && found["ladder"][2]["held_out_rmse_n"].is_number()
    );
}

#[test]
fn the_error_falls_and_comes_back() {
    let (_folder, page) = opened();
    page.put(&effects(&["end-taper"]));
    page.put(&effects(&["end-taper", "bladder-elasticity"]));
    let session = page.put(&effects(&["end-taper", "bladder-elasticity", "coulomb-friction"])).json();
    let command =
        "bulge compare loops.csv --muscle braid.toml --with end-taper,bladder-elasticity,coulomb-friction";
    assert_eq!(session["command"], command);
    let errors = page.errors();
    assert!(errors.len() == 4 && errors.windows(2).all(|pair| pair[1] < 0.8 * pair[0]), "{errors:?}");
    page.ask("POST", "api/undo", b"");
    assert_eq!(page.errors(), errors[..3]);
    page.ask("POST", "api/undo", b"");
    page.ask("POST", "api/redo", b"");
    assert_eq!(page.errors(), errors[..3]);
    // The file with the fitted effects can be read as a muscle.
    let learnt = String::from_utf8(page.get("learnt.toml").body).unwrap();
    assert!(
        from_toml(&learnt, "learnt").is_ok() && learnt.contains("[effects.bladder-elasticity]"),
        "{learnt}"
    );
}

#[test]
fn a_number_is_held_and_fitted_again() {
    let (_folder, page) = opened();
    page.put(&effects(&["end-taper", "bladder-elasticity", "coulomb-friction"]));
    let fitted = page.errors();
    let with = |force: f64| json!({"effects": [{"name": "end-taper"}, {"name": "bladder-elasticity"}, {"name": "coulomb-friction", "hold": {"force": force}}]});
    let session = page.put(&with(5.0)).json();
    assert!(
        session["command"].as_str().unwrap().ends_with("--hold \"coulomb-friction.force=5 N\""),
        "{}",
        session["command"]
    );
    let says = "muscle, [\"end-taper\", \"bladder-elasticity\", \"coulomb-friction\"], hold={\"coulomb-friction.force\": \"5 N\"}))";
    assert!(session["python"].as_str().unwrap().ends_with(says), "{}", session["python"]);
    let comparison = page.get("comparison?held_out=0").json();
    let rung = &comparison["ladder"][3];
    // The remaining friction 13.94 - 5 N changes sign with the direction: the error is the root of the sum of
    // squares.
    let expected = (fitted[3].powi(2) + (13.94_f64 - 5.0).powi(2)).sqrt();
    assert!(
        (rung["rmse_n"].as_f64().unwrap() / expected - 1.0).abs() < 0.01,
        "{} {expected}",
        rung["rmse_n"]
    );
    assert!(
        rung["held"][0]["value"] == 5.0 && rung["fit"]["parameters"].as_array().unwrap().len() == 1,
        "{rung}"
    );
    let (place, error) = page.put(&with(-5.0)).refusal();
    assert!(place == "effects" && error.contains("coulomb-friction"), "{error}");
    let (place, error) =
        page.put(&json!({"effects": [{"name": "coulomb-friction", "hold": {"farce": 5.0}}]})).refusal();
    assert!(place == "effects" && error.contains("coulomb-friction.force"), "{error}");
    page.ask("POST", "api/undo", b"");
    assert_eq!(page.errors(), fitted);
}

/// A drag of the slider of any length is undone in one step.
#[test]
fn one_drag_is_one_step() {
    let (_folder, page) = opened();
    page.put(&effects(&["coulomb-friction"]));
    let fitted = page.errors();
    for (force, goes_on) in [(5.0, false), (7.0, true), (9.0, true)] {
        let hold = json!([{"name": "coulomb-friction", "hold": {"force": force}}]);
        page.put(&json!({"effects": hold, "goes_on": goes_on}));
    }
    assert_eq!(page.get("session").json()["effects"][0]["hold"]["force"], 9.0);
    page.ask("POST", "api/undo", b"");
    assert_eq!(page.errors(), fitted);
    let redone = page.ask("POST", "api/redo", b"").json();
    assert_eq!(redone["effects"][0]["hold"]["force"], 9.0);
}

/// The bulge is that of the fitted model: clamped ends are narrower than those of a cylinder.
#[test]
fn the_shape_follows_what_was_learnt() {
    let (_folder, page) = opened();
    let shape = || page.get("shape?pressure_pa=3e5&contraction=0.1").json();
    let narrowest = |shape: &Value| {
        let radius = shape["fields"]
            .as_array()
            .unwrap()
            .iter()
            .find(|field| field["name"] == "radius")
            .unwrap()
            .clone();
        assert_eq!(radius["unit"], "m");
        let values: Vec<f64> =
            radius["values"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
        assert_eq!(shape["points"].as_array().unwrap().len(), 3 * values.len());
        values.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let stated = shape();
    page.put(&effects(&["end-taper"]));
    let learnt = shape();
    // A clamped end keeps the radius of the unpressurised braid, 10.725 mm.
    assert!(
        (narrowest(&learnt) - 10.725e-3).abs() < 1e-6 && narrowest(&stated) > 12e-3,
        "{}",
        narrowest(&learnt)
    );
    assert!(learnt["force_n"].as_f64().unwrap() < stated["force_n"].as_f64().unwrap());
    let number = |name: &str| learnt[name].as_f64().unwrap();
    assert!(
        (number("length_m") - 0.225).abs() < 1e-9 && number("radius_m") > 12e-3 && number("radius_m") < 16e-3
    );
    // The extent of the surface matches the reported numbers.
    let points: Vec<f64> =
        learnt["points"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
    let widest = points.chunks(3).map(|point| point[1].hypot(point[2])).fold(0.0, f64::max);
    let ends = points.chunks(3).map(|point| point[0]);
    let length = ends.clone().fold(f64::MIN, f64::max) - ends.fold(f64::MAX, f64::min);
    assert!(
        (widest / number("radius_m") - 1.0).abs() < 1e-3 && (length / 0.225 - 1.0).abs() < 1e-3,
        "{widest} {length}"
    );
    let file = page.get("shape.vtp?pressure_pa=3e5&contraction=0.1").body;
    assert!(file.starts_with(b"<?xml") && file.len() > 10_000);
}

/// A planned test is evaluated for the fitted muscle, and the file saved is the same test.
#[test]
fn a_plan_is_that_of_the_library() {
    let (_folder, page) = opened();
    let asked = json!({
        "blocks": [
            {"pressures_pa": [2e5, 4e5], "contraction": [0.01, 0.15], "path": "triangle", "cycles": 2, "period_s": 50.0,
             "rows": 40, "repeats": 1, "specimens": 1},
            {"pressures_pa": [1e5, 5e5], "contraction": [0.05, 0.1], "held": [0.05, 0.1], "path": "sine", "cycles": 1,
             "period_s": 20.0, "rows": 30, "repeats": 1, "specimens": 1}
        ],
        "noise": {"force_n": 2.0}, "steps": {}, "rig": "none", "pause_s": 10.0, "warming_k": 0.0
    });
    let plan = |asked: &Value| page.ask("POST", "api/plan", asked.to_string().as_bytes());
    let stated = plan(&asked).json();
    let protocol = Protocol::from_toml(stated["toml"].as_str().unwrap(), "p.toml").unwrap();
    assert_eq!(protocol, serde_json::from_value::<Protocol>(asked.clone()).unwrap());
    let muscle = from_toml(MUSCLE, "braid.toml").unwrap();
    let by_library = |muscle: &Muscle| {
        let catalogue = Catalogue::builtin();
        let known = known(muscle, &catalogue).unwrap();
        let plan = bulge_inference::plan(muscle, &known, &catalogue, &protocol).unwrap();
        // Compared by way of the text, as the page has it: reading it may round the last digit.
        serde_json::from_str::<Value>(&serde_json::to_string(&plan).unwrap()).unwrap()
    };
    assert_eq!(stated["plan"], by_library(&muscle));
    assert_eq!(stated["plan"]["rows"], 2 * 80 + 2 * 30);
    let data = Data::from_csv(DATA, "loops.csv").unwrap();
    let like = Protocol::like(&data, muscle.length().si());
    assert_eq!(page.get("protocol").json(), serde_json::to_value(&like).unwrap());
    page.put(&effects(&["coulomb-friction"]));
    let learnt = String::from_utf8(page.get("learnt.toml").body).unwrap();
    let found = plan(&asked).json();
    assert_eq!(found["plan"], by_library(&from_toml(&learnt, "learnt.toml").unwrap()));
    assert_ne!(found["plan"], stated["plan"]);
    let mut wrong = asked.clone();
    wrong["blocks"][0]["period_s"] = json!(0.0);
    let (place, says) = plan(&wrong).refusal();
    assert!(place == "plan" && says.contains("a period of 0 s is not possible"), "{place}: {says}");
    wrong["blocks"][0]["periode"] = json!(1.0);
    assert_eq!(plan(&wrong).refusal().0, "request");
}

/// Preparing for an effect changes no answer and no choice.
#[test]
fn getting_ready_changes_nothing() {
    let (_folder, page) = opened();
    let before = page.get("session").json();
    let ready = page.ask("POST", "api/prepare", br#"[{"name": "end-taper"}]"#);
    assert_eq!(ready.status, 200);
    assert_eq!(page.get("session").json(), before);
    page.put(&effects(&["end-taper"]));
    let prepared = page.get("comparison?held_out=0").body;
    let (_other, fresh) = opened();
    fresh.put(&effects(&["end-taper"]));
    assert_eq!(prepared, fresh.get("comparison?held_out=0").body);
    let unknown = page.ask("POST", "api/prepare", br#"[{"name": "end-tapper"}]"#);
    assert_eq!(unknown.refusal().0, "effects");
}

/// A column of 32-bit numbers from the bytes of the rows.
fn column(bytes: &[u8], name: &str) -> Vec<f32> {
    let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
    let header: Value = serde_json::from_slice(&bytes[4..4 + length]).unwrap();
    let rows = usize::try_from(header["rows"].as_u64().unwrap()).unwrap();
    let place =
        header["columns"].as_array().unwrap().iter().position(|column| column["name"] == name).unwrap();
    assert!(
        length.is_multiple_of(4)
            && bytes.len() == 4 + length + 4 * rows * header["columns"].as_array().unwrap().len()
    );
    let start = 4 + length + 4 * rows * place;
    bytes[start..start + 4 * rows]
        .chunks(4)
        .map(|four| f32::from_le_bytes(four.try_into().unwrap()))
        .collect()
}

#[test]
fn rows_have_the_error_of_the_ladder_and_can_be_excluded() {
    let (_folder, page) = opened();
    page.put(&effects(&["end-taper"]));
    let rmse = |bytes: &[u8]| {
        let (measured, model, state) =
            (column(bytes, "measured"), column(bytes, "model"), column(bytes, "state"));
        let squares = (0..state.len())
            .filter(|row| state[*row] > 0.0)
            .map(|row| f64::from(measured[row] - model[row]).powi(2));
        let squares: Vec<f64> = squares.collect();
        ((squares.iter().sum::<f64>() / squares.len() as f64).sqrt(), squares.len())
    };
    let before = page.get("rows").body;
    let (error, all) = rmse(&before);
    assert!((error / page.errors()[1] - 1.0).abs() < 1e-4 && all == 750, "{error}, {all}");
    let lines = column(&before, "line");
    // The first row of the file, in the units of the header.
    let first = ["time", "pressure", "contraction", "measured"].map(|name| column(&before, name)[0]);
    assert_eq!(first.map(f32::to_bits), [0.0_f32, 2.0, 1.01, 501.6].map(f32::to_bits));
    let session = page.put(&json!({"excluded": [10, 11, 12]})).json();
    let says = format!("--exclude {}-{}", lines[10], lines[12]);
    assert!(session["command"].as_str().unwrap().contains(&says), "{session}");
    let says =
        format!("print(bulge.compare(data, muscle, \"end-taper\", exclude=\"{}-{}\"))", lines[10], lines[12]);
    assert!(session["python"].as_str().unwrap().ends_with(&says), "{}", session["python"]);
    let after = page.get("rows").body;
    assert!(rmse(&after).1 == 747 && column(&after, "state")[10..13] == [-1.0; 3]);
    let left_out = page.get("comparison?held_out=0").json()["data"]["left_out"].to_string();
    assert!(left_out.contains("excluded by hand"), "{left_out}");
    // Saved as a file they can be read as measurements, with the same error.
    let file =
        Data::from_bytes(&page.get("rows.csv").body, "rows.csv", &bulge_measurements::ReadOptions::default())
            .unwrap();
    assert!(
        file.len() == 750
            && file.force()[100].to_bits() == Data::from_csv(DATA, "a").unwrap().force()[100].to_bits()
    );
    let (place, error) = page.put(&json!({"excluded": (0..750).collect::<Vec<_>>()})).refusal();
    assert!(place == "excluded" && error.contains("all rows"), "{error}");
}

/// What the server sends and stores, in every state: effects with fixed parameters, excluded rows, a
/// diagnosis, unknown columns, steps to undo and redo.
#[test]
fn documents_hold_what_their_schemas_name() {
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().join("session");
    let page = Page::open(tour(folder.path()), Some(session.clone()), true);
    let kept =
        || serde_json::from_slice::<Value>(&std::fs::read(session.join("session.json")).unwrap()).unwrap();
    let mut all = vec![page.get("session").json(), kept()];
    for change in [
        json!({"effects": [{"name": "coulomb-friction", "hold": {"force": 5.0}}], "excluded": [3, 4], "view": {"theme": "dark"}}),
        json!({"muscle": {"shipped": "dmsp-20-250"}}),
        json!({"columns": "force=there is none"}),
    ] {
        all.extend([page.put(&change).json(), kept()]);
    }
    assert!(all[6]["problem"].is_object() && all[7]["past"].as_array().unwrap().len() == 3, "{}", all[6]);
    page.ask("POST", "api/undo", b"");
    page.ask("POST", "api/undo", b"");
    all.extend(
        ["shape?pressure_pa=2e5&contraction=0.1", "effects", "comparison?held_out=0"]
            .map(|call| page.get(call).json()),
    );
    let kinds: BTreeSet<String> = all.iter().map(|document| schema::holds(document).0).collect();
    let expected = ["comparison", "effects", "session", "session-file", "surface"];
    assert_eq!(kinds.iter().map(String::as_str).collect::<Vec<_>>(), expected);
}

#[test]
fn what_is_wrong_is_said_where_it_is_and_changes_nothing() {
    let (_folder, page) = opened();
    let before = page.get("session").json();
    for (change, place, part) in [
        (effects(&["end-tapper"]), "effects", "did you mean `end-taper`"),
        (effects(&["creep", "creep"]), "effects", "acts once"),
        (json!({"muscle": {"toml": "length = 3"}}), "muscle", "length"),
        (json!({"muscle": {"shipped": "nobody"}}), "muscle", "no shipped muscle"),
        (json!({"columns": "force"}), "columns", "force"),
        (json!({"own_effects": "[effects.x]\nforce = \"1 +\""}), "own_effects", "x"),
        (json!({"colums": ""}), "request", "colums"),
        (json!({"excluded": [99999]}), "excluded", "99999"),
    ] {
        let (found, error) = page.put(&change).refusal();
        assert!(found == place && error.contains(part), "{change}: {found}, {error}");
    }
    assert_eq!(page.get("session").json(), before);
    let (place, _) = page.get("shape?pressure_pa=1e5&contraction=0.9").refusal();
    assert_eq!(place, "shape");
    let unsuitable = |name: &str| {
        let cards = page.get("effects").json();
        let card =
            cards["effects"].as_array().unwrap().iter().find(|card| card["name"] == name).unwrap().clone();
        card["unsuitable"].as_str().map(str::to_owned)
    };
    assert!(unsuitable("fibre-count").unwrap().contains("pleated") && unsuitable("creep").is_none());
}

#[test]
fn a_dropped_file_whose_columns_are_strange_is_mapped_by_hand() {
    let (_folder, page) = opened();
    let text = "alpha;beta;<img src=x onerror=alert(1)>\n2,0;1,5;501\n2,0;2,5;480\n2,0;3,5;460\n2,0;4,5;440\n2,0;5,5;420\n";
    let session = page.ask("POST", "api/data?name=..%2F..%2Fmy%20loops.csv", text.as_bytes()).json();
    assert_eq!(session["data"]["names"], json!(["my loops.csv"]));
    assert_eq!(session["problem"]["where"], "columns");
    let named: Vec<&str> = session["reading"]["columns"]
        .as_array()
        .unwrap()
        .iter()
        .map(|use_| use_["column"].as_str().unwrap())
        .collect();
    assert!(named.starts_with(&["alpha", "beta"]) && named[2].contains("img"), "{named:?}");
    assert_eq!(page.get("comparison").refusal().0, "columns");
    let columns = format!("pressure=alpha [bar], displacement=beta [mm], force={} [N]", named[2]);
    let session = page.put(&json!({"columns": columns})).json();
    assert!(session["problem"].is_null() && session["data"]["rows"] == 5, "{}", session["problem"]);
    // Back to the data of the tour, with its columns.
    page.ask("POST", "api/undo", b"");
    let session = page.ask("POST", "api/undo", b"").json();
    assert!(session["problem"].is_null() && session["data"]["rows"] == 750, "{session}");
}

#[test]
fn a_file_that_is_none_takes_nothing_away() {
    let (_folder, page) = opened();
    let bytes: Vec<u8> = (0..4096_u32).map(|i| u8::try_from((i * 7919) % 256).unwrap()).collect();
    let session = page.ask("POST", "api/data?name=noise.bin", &bytes).json();
    assert_eq!(session["problem"]["where"], "data");
    assert!(session["can_undo"] == true);
    assert_eq!(page.get("comparison").refusal().0, "data");
    assert!(page.get("effects").json()["effects"].as_array().unwrap().len() > 40);
    assert!(page.ask("POST", "api/undo", b"").json()["problem"].is_null());
    // Two files with the same name keep their rows separate.
    page.ask("POST", "api/data?name=twin.csv", DATA.as_bytes());
    let session =
        page.ask("POST", "api/data?name=twin.csv&add=1", DATA.replace("2.0000", "2.0001").as_bytes()).json();
    assert_eq!(session["data"]["names"], json!(["twin.csv", "twin-2.csv"]));
    assert_eq!(session["data"]["rows"], 1500);
    assert_eq!(page.ask("POST", "api/data?name=", b"x").refusal().0, "data");
    // Refused before it is read: its body is never sent.
    let (host, token) = (&page.host, &page.token);
    let head = format!(
        "POST /{token}/api/data?name=a.csv HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\nContent-Length: 3000000000\r\n\r\n"
    );
    let (place, error) = page.send(&head, b"").refusal();
    assert!(place == "data" && error.contains("2 GiB"), "{error}");
}

#[test]
fn only_the_page_of_this_run_is_answered() {
    let (_folder, page) = opened();
    let (host, token) = (&page.host, &page.token);
    let evil = |lines: &str, token: &str| {
        let head = format!(
            "PUT /{token}/api/session HTTP/1.1\r\n{lines}Connection: close\r\nContent-Length: 2\r\n\r\n"
        );
        page.send(&head, b"{}").status
    };
    let own = format!("Host: {host}\r\n");
    assert_eq!(evil(&own, token), 200);
    assert_eq!(evil(&own, &"0".repeat(32)), 403);
    assert_eq!(evil("Host: evil.example\r\n", token), 403);
    assert_eq!(evil(&format!("{own}Origin: http://evil.example\r\n"), token), 403);
    assert_eq!(evil(&format!("{own}Origin: http://{host}\r\n"), token), 200);
    let index = page.ask("GET", "", b"");
    assert!(
        index.status == 200
            && index.head.contains("content-security-policy")
            && !index.head.contains("unsafe")
    );
    let text = String::from_utf8(index.body).unwrap();
    assert!(
        !text.contains("style=\"") && !text.contains("http://") && !text.contains("https://"),
        "nothing inline, nothing from elsewhere"
    );
    assert_eq!(page.ask("GET", "../Cargo.toml", b"").status, 422);
}

/// A killed process loses nothing: a second one finds everything that the first one stored.
#[test]
fn a_session_is_found_again() {
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().join("session");
    let first = Page::open(tour(folder.path()), Some(session.clone()), true);
    first.put(&effects(&["end-taper"]));
    first.ask("POST", "api/data?name=more.csv", DATA.replace("2.0000", "2.0001").as_bytes());
    let left = first.put(&json!({"view": {"theme": "dark"}})).json();
    let second = Page::open(tour(folder.path()), Some(session.clone()), false);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = std::fs::metadata(session.join("session.json")).unwrap().permissions().mode();
        assert_eq!(mode & 0o077, 0, "others could read the token");
    }
    // An open page needs no other address.
    assert_eq!(second.token, first.token);
    let found = second.get("session").json();
    for field in ["data", "effects", "muscle", "command", "can_undo", "view"] {
        assert_eq!(found[field], left[field], "{field}");
    }
    // Undo works across the restart; choices given on the command line are a further step.
    second.ask("POST", "api/undo", b"");
    assert_eq!(second.get("session").json()["data"]["names"], json!(["loops.csv"]));
    // The same choices again continue the session; other ones are a further step.
    let same = Page::open(tour(folder.path()), Some(session.clone()), true).get("session").json();
    assert_eq!(same["effects"], left["effects"]);
    let other = Choices { columns: Some("force=force".to_owned()), ..tour(folder.path()) };
    let third = Page::open(other, Some(session.clone()), true).get("session").json();
    assert!(third["effects"] == json!([]) && third["can_undo"] == true);
    std::fs::write(session.join("session.json"), "{").unwrap();
    let start = Start { choices: tour(folder.path()), is_stated: false, port: 0, session: Some(session) };
    let error = serve(start, |_| ()).unwrap_err().to_string();
    assert!(error.contains("session.json") && error.contains("--session"), "{error}");
}

#[test]
fn a_diagnosis_is_told_by_stages_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().join("session");
    let page = Page::open(tour(folder.path()), Some(session.clone()), true);
    page.put(&effects(&["end-taper", "bladder-elasticity"]));
    assert_eq!(page.get("diagnosis.json").status, 422);
    let told = String::from_utf8(page.ask("POST", "api/diagnose", b"").body).unwrap();
    assert!(
        told.matches("event: progress").count() > 5 && told.matches("event: result").count() == 1,
        "{}",
        &told[..200]
    );
    let result = told.split("event: result\ndata: ").nth(1).unwrap().lines().next().unwrap();
    let found: Value = serde_json::from_str(result).unwrap();
    assert!(
        found["verdict"] == "missing" && found["missing"][0]["effect"] == "coulomb-friction",
        "{}",
        found["missing"]
    );
    assert_eq!(page.get("diagnosis.json").json(), found);
    // All three documents are what their schemas say.
    let kept: Value = serde_json::from_slice(&std::fs::read(session.join("session.json")).unwrap()).unwrap();
    let all = [found.clone(), page.get("session").json(), kept];
    assert!(all[1]["diagnosis"].is_object() && all[2]["diagnosed"].is_object(), "{}", all[1]);
    let kinds = all.map(|document| schema::holds(&document).0);
    assert_eq!(kinds, ["diagnosis", "session", "session-file"]);
    // Reports contain the rows, and may run only their own script.
    for report in ["report", "diagnosis-report"] {
        let answer = page.get(report);
        let text = String::from_utf8(answer.body).unwrap();
        assert!(text.starts_with("<!") && text.contains("<script id=\"rows\""), "{report}");
        let policy = bulge_report::policy(true);
        assert!(text.contains(&policy) && answer.head.contains(&policy), "{report}: {}", answer.head);
    }
    // The diagnosis outlives the process, and the session knows whether it is about the present choices.
    let again = Page::open(tour(folder.path()), Some(session), false);
    assert_eq!(again.get("diagnosis.json").json(), found);
    assert_eq!(again.get("session").json()["diagnosis"]["is_current"], true);
    assert_eq!(again.put(&json!({"excluded": [3]})).json()["diagnosis"]["is_current"], false);
}
