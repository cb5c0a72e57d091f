//! Exports of tables with random coefficients, for every form and every number of axes and outputs.

use super::*;
use bulge_numerics::Random;
use bulge_table::crc64;
use bulge_table::format::{FITTED, MAGIC, NAME, ROOT, UNIT, VERSION};
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

/// Properties of a random table.
#[derive(Debug, Clone, Copy)]
struct Like {
    form: u8,
    bytes: u8,
    axes: usize,
    outputs: usize,
    flags: u32,
    text: &'static str,
}

const PLAIN: Like = Like { form: 1, bytes: 8, axes: 2, outputs: 2, flags: 0, text: "{\"from\": \"*/ ??/\"}" };

/// The bytes of a table whose axes go from i to i + 1.5. The axis after the first has no pole.
fn random_table(like: Like, seed: u64) -> Vec<u8> {
    let mut random = Random::new(seed, 0);
    let Like { axes, outputs, .. } = like;
    let nodes = |i: usize| if like.form == 1 { 5 + i } else { 4 + 2 * i };
    let is_fitted = like.flags & FITTED != 0;
    let mut numbers = |count: usize, middle: f64, each: u8| -> Vec<u8> {
        #[expect(clippy::cast_possible_truncation, reason = "what single precision means")]
        let one =
            |x: f64| if each == 4 { (x as f32).to_le_bytes().to_vec() } else { x.to_le_bytes().to_vec() };
        (0..count).flat_map(|_| one(middle + random.uniform() - 0.5)).collect()
    };
    // K = 1.7 to 2.7 and c = 0.7 to 1.7: the edge is at q = 1/K.
    let edge =
        if is_fitted { numbers(2 * (1..axes).map(|i| 4 + i).product::<usize>(), 2.2, 8) } else { vec![] };
    let data = numbers(outputs * (0..axes).map(nodes).product::<usize>(), 1.0, like.bytes);
    let records = 64 + 96 * axes + 104 * outputs;
    let place = |n: usize| u32::try_from(n).unwrap().to_le_bytes();
    let mut bytes = MAGIC.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend([like.form, like.bytes, u8::try_from(axes).unwrap(), u8::try_from(outputs).unwrap(), 0, 0]);
    let text = records + edge.len() + data.len();
    for at in [text + like.text.len() + 8, records + edge.len(), records, text] {
        bytes.extend(place(at));
    }
    bytes.extend(1000_u64.to_le_bytes());
    bytes.extend(7_u64.to_le_bytes());
    bytes.extend(place(like.text.len()));
    bytes.extend(like.flags.to_le_bytes());
    bytes.extend(1e-9_f64.to_le_bytes());
    let named = |bytes: &mut Vec<u8>, name: &str, unit: &str| {
        for (text, length) in [(name, NAME), (unit, UNIT)] {
            bytes.extend(text.as_bytes());
            bytes.resize(bytes.len() + length - text.len(), 0);
        }
    };
    for i in 0..axes {
        named(&mut bytes, &format!("axis,{i}"), if i == 0 { "1" } else { "Pa" });
        let (low, high) = (i as f64, i as f64 + 1.5);
        let width = if i == 0 && like.flags & ROOT != 0 { 1.5_f64.sqrt() } else { 1.5 };
        let (pole, scale) = if i == 1 { (f64::INFINITY, 1.0 / 1.5) } else { (0.8, (width + 0.8) / width) };
        for number in [low, high, pole, scale] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(place(nodes(i)));
        bytes.extend(place(if is_fitted && i > 0 { 4 + i } else { 0 }));
        bytes.extend([0; 8]);
    }
    for o in 0..outputs {
        named(&mut bytes, &format!("output {o}"), "N");
        // All four combinations of the factors.
        bytes.extend([u8::from(o % 4 == 1 || o % 4 == 3), u8::from(o % 4 >= 2), 0, 0, 0, 0, 0, 0]);
        bytes.extend((0..6).flat_map(|i| (1e-7 * f64::from(i + 1)).to_le_bytes()));
    }
    bytes.extend(edge);
    bytes.extend(data);
    bytes.extend(like.text.as_bytes());
    let sum = crc64(&bytes);
    bytes.extend(sum.to_le_bytes());
    bytes
}

/// Points inside, outside and at the ends, and NaN.
fn points(table: &Table<'_>, count: usize) -> Vec<Vec<f64>> {
    let mut random = Random::new(3, 0);
    let axes = axes(table);
    let mut points: Vec<Vec<f64>> = (0..count)
        .map(|_| axes.iter().map(|a| a.low + (1.1 * random.uniform() - 0.02) * (a.high - a.low)).collect())
        .collect();
    for i in 0..axes.len() {
        for x in
            [axes[i].low, axes[i].high, f64::NAN, f64::INFINITY, axes[i].low - 1e-300, axes[i].high.next_up()]
        {
            let mut point: Vec<f64> = axes.iter().map(|a| 0.75 * a.low + 0.25 * a.high).collect();
            point[i] = x;
            points.push(point);
        }
    }
    points
}

const MAIN: &str = "
#include <stdio.h>
int main(void) {
    double x[A], y[O], dy[O][A], in;
    while (fread(x, sizeof x, 1, stdin) == 1) {
        in = t_at(x, y, dy);
        fwrite(&in, sizeof in, 1, stdout);
        fwrite(y, sizeof y, 1, stdout);
        fwrite(dy, sizeof dy, 1, stdout);
    }
    return 0;
}
";

/// Compiles the header of a table and evaluates it at points. For each point it returns 1 or 0, the outputs
/// and the derivatives.
fn asked_in_c(folder: &Path, table: &Table<'_>, points: &[Vec<f64>]) -> Vec<f64> {
    std::fs::write(folder.join("t.h"), c_header(table, "t").unwrap()).unwrap();
    let size = format!("enum {{ A = {}, O = {} }};\n", table.axes(), table.outputs());
    // Twice: the guard works.
    let main = format!("#include \"t.h\"\n#include \"t.h\"\n{size}{MAIN}");
    std::fs::write(folder.join("t.c"), main).unwrap();
    let compiler = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "t.c", "-o", "t", "-lm"];
    let compiled = Command::new("cc").current_dir(folder).args(compiler).output().unwrap();
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let mut child =
        Command::new(folder.join("t")).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let bytes: Vec<u8> = points.iter().flatten().flat_map(|x| x.to_ne_bytes()).collect();
    let writer = std::thread::spawn(move || stdin.write_all(&bytes));
    let answer = child.wait_with_output().unwrap().stdout;
    writer.join().unwrap().unwrap();
    answer.chunks_exact(8).map(|chunk| f64::from_ne_bytes(chunk.try_into().unwrap())).collect()
}

/// Compares the C code with the lookup; returns the number of points inside.
fn compared(folder: &Path, like: Like) -> usize {
    let bytes = random_table(like, 11);
    let table = Table::from_bytes(&bytes).unwrap();
    let points = points(&table, 2000);
    let answers = asked_in_c(folder, &table, &points);
    let (a, o) = (table.axes(), table.outputs());
    let each = 1 + o + o * a;
    assert_eq!(answers.len(), each * points.len());
    let (mut values, mut gradients) = (vec![0.0; o], vec![0.0; o * a]);
    let mut inside = 0;
    for (point, answer) in points.iter().zip(answers.chunks_exact(each)) {
        let found = table.sample(point, &mut values, &mut gradients);
        assert_eq!(answer[0] != 0.0, found.is_some(), "{like:?} {point:?}");
        if found.is_none() {
            continue;
        }
        inside += 1;
        let found = (&answer[1..=o], &answer[1 + o..]);
        // The coefficients are about 1, and so are the terms of a sum.
        for (exact, found) in values.iter().zip(found.0) {
            assert!(
                (exact - found).abs() <= 1e-13 * exact.abs().max(0.1),
                "{like:?} {point:?}: {exact} {found}"
            );
        }
        for (exact, found) in gradients.chunks_exact(a).zip(found.1.chunks_exact(a)) {
            // The terms cancel; they are as large as the largest component.
            let size = exact.iter().fold(0.1_f64, |size, x| size.max(x.abs()));
            for (exact, found) in exact.iter().zip(found) {
                assert!((exact - found).abs() <= 1e-13 * size, "{like:?} {point:?}: {exact} {found}");
            }
        }
    }
    inside
}

#[test]
fn c_repeats_the_lookup() {
    if Command::new("cc").arg("--version").output().is_err() {
        println!("skipped: there is no C compiler");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let all = [
        PLAIN,
        Like { flags: ROOT | FITTED, bytes: 4, outputs: 4, ..PLAIN },
        Like { form: 2, flags: ROOT | FITTED, ..PLAIN },
        Like { axes: 1, outputs: 8, flags: ROOT, ..PLAIN },
        Like { axes: 1, outputs: 1, form: 2, bytes: 4, ..PLAIN },
        Like { axes: 3, outputs: 5, flags: FITTED, ..PLAIN },
        Like { axes: 3, outputs: 3, form: 2, ..PLAIN },
        Like { axes: 4, outputs: 4, flags: ROOT | FITTED, bytes: 4, ..PLAIN },
    ];
    for like in all {
        let inside = compared(folder.path(), like);
        assert!((500..2010).contains(&inside), "{like:?}: {inside}");
    }
}

#[test]
fn names_are_checked() {
    let bytes = random_table(PLAIN, 1);
    let table = Table::from_bytes(&bytes).unwrap();
    for name in ["", "1A", "A B", "a", "A-B", "_A", "\u{c4}"] {
        assert!(rust_source(&table, name).unwrap_err().to_string().contains("`KNEE_TORQUE`"), "{name}");
    }
    for name in ["", "1a", "a b", "a-b", "_a", "\u{e4}"] {
        assert!(c_header(&table, name).unwrap_err().to_string().contains("`knee_torque`"), "{name}");
    }
}

#[test]
fn the_header_describes_the_table() {
    let bytes = random_table(PLAIN, 1);
    let text = c_header(&Table::from_bytes(&bytes).unwrap(), "knee").unwrap();
    for part in [
        "axis 1: axis,1, 1 to 2.5 Pa",
        "output 1: output 1 N, largest relative error 1.00e-7 (bound 5.00e-7), of the gradient 3.00e-7",
        "errors measured at 1000 points from number 7 on",
        // The comment is not ended.
        "from: {\"from\": \"* / ? ?/\"}",
        "#ifndef KNEE_H",
        "static const double knee_coefficients[60]",
        "static inline int knee_at(const double x[2], double y[2], double dy[2][2])",
    ] {
        assert!(text.contains(part), "{part}");
    }
    assert_eq!(text.matches("#include").count(), 2);
}

#[test]
fn rust_holds_the_bytes() {
    let bytes = random_table(Like { text: "a\r\nb", ..PLAIN }, 1);
    let text = rust_source(&Table::from_bytes(&bytes).unwrap(), "KNEE_2").unwrap();
    assert!(text.starts_with("//! The table `KNEE_2`"));
    assert!(text.contains("//! - from: a  b\n"));
    assert!(text.contains(
        "pub fn lookup() -> Result<bulge_table::Lookup<'static, 2, 2>, bulge_table::TableError> {"
    ));
    let (_, list) = text.split_once(&format!("pub static KNEE_2: [u8; {}] = [", bytes.len())).unwrap();
    let found: Vec<u8> =
        list.trim_end_matches("];\n").split(',').filter_map(|n| n.trim().parse().ok()).collect();
    assert_eq!(found, bytes);
}

#[test]
fn csv_follows_the_edge() {
    let bytes = random_table(Like { flags: FITTED | ROOT, ..PLAIN }, 5);
    let table = Table::from_bytes(&bytes).unwrap();
    let text = csv(&table, 5).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines[0],
        "\"axis,0 [1]\",\"axis,1 [Pa]\",output 0 [N],output 1 [N],\"d(output 0)/d(axis,0) [N]\",\"d(output 0)/d(axis,1) [N/(Pa)]\",\
         \"d(output 1)/d(axis,0) [N]\",\"d(output 1)/d(axis,1) [N/(Pa)]\""
    );
    assert_eq!(lines.len(), 26);
    let (mut values, mut gradients) = ([0.0; 2], [0.0; 4]);
    for (i, line) in lines[1..].iter().enumerate() {
        let row: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        assert!(row.iter().all(|x| x.is_finite()) && row.len() == 8, "{line}");
        table.sample(&row[..2], &mut values, &mut gradients).unwrap();
        assert_eq!((&row[2..4], &row[4..]), (&values[..], &gradients[..]));
        let end = table.upper_end(&row[..2]).unwrap();
        if i >= 20 {
            assert!((row[0] - end).abs() < 1e-8, "{line}");
        }
    }
    for (points, says) in [(1, "a grid of 1 points per axis"), (100_000, "use fewer points")] {
        assert!(csv(&table, points).unwrap_err().to_string().contains(says));
    }
    assert!(csv(&table, usize::MAX).is_err());
}

#[test]
fn json_holds_everything() {
    let bytes = random_table(Like { bytes: 4, flags: FITTED, ..PLAIN }, 5);
    let table = Table::from_bytes(&bytes).unwrap();
    let value = json(&table);
    assert_eq!(value["source"]["from"], "*/ ??/");
    assert_eq!((&value["form"], &value["form_code"]), (&"cubic B-splines".into(), &1.into()));
    assert_eq!((&value["checks"]["points"], &value["edge_error"]), (&1000.into(), &1e-9.into()));
    assert_eq!(value["axes"][1]["pole"], serde_json::Value::Null);
    assert_eq!((&value["axes"][0]["pole"], &value["axes"][1]["edge_nodes"]), (&0.8.into(), &5.into()));
    assert_eq!(value["outputs"][1]["is_singular"], true);
    assert_eq!(value["outputs"][0]["certificate"]["gradient_max"], 1e-7 * 3.0);
    let [edge, data] = coefficients(&table);
    let list = |name: &str| -> Vec<f64> {
        value[name].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
    };
    // The shortest digits that read back as the same bits.
    assert!(value.to_string().contains(&format!("\"edge\":[{:?},{:?},", edge[0], edge[1])));
    assert_eq!((list("edge"), list("coefficients")), (edge, data));
    // Text that isn't JSON stays text.
    let bytes = random_table(Like { text: "by hand", ..PLAIN }, 5);
    assert_eq!(json(&Table::from_bytes(&bytes).unwrap())["source"], "by hand");
}
