//! Files on disk: CSV and Parquet by extension or first bytes, several files, a measured data set.

#![expect(
    clippy::unwrap_used,
    clippy::float_cmp,
    clippy::type_complexity,
    reason = "a test that cannot be set up fails; values are exact by construction"
)]

use bulge_measurements::{Data, SweepKind, Trace};
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type,
};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const CSV: &str = "pressure [bar],length [mm],force [N],time [s],cycle,specimen\n\
                   1,300,50,0,1,left\n1,290,40,0.5,1,left\n2,280,60.5,1,2,right\n";

fn written(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn column<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, File>,
    values: &[T::T],
    levels: Option<&[i16]>,
) {
    let mut writer = group.next_column().unwrap().unwrap();
    writer.typed::<T>().write_batch(values, levels, None).unwrap();
    writer.close().unwrap();
}

/// A Parquet file with this schema; each group of rows is written by `groups`.
fn parquet(path: &Path, schema: &str, groups: &[&dyn Fn(&mut SerializedRowGroupWriter<'_, File>)]) {
    let schema = Arc::new(parse_message_type(schema).unwrap());
    let properties = WriterProperties::builder().set_compression(parquet::basic::Compression::SNAPPY).build();
    let mut writer =
        SerializedFileWriter::new(File::create(path).unwrap(), schema, Arc::new(properties)).unwrap();
    for fill in groups {
        let mut group = writer.next_row_group().unwrap();
        fill(&mut group);
        group.close().unwrap();
    }
    writer.close().unwrap();
}

// The schema parser only knows bare names with blanks and brackets: "length[mm]" is read like "length [mm]".
const SCHEMA: &str =
    "message schema { required double pressure[bar]; required float length[mm]; required int32 force[N];
    optional double time[s]; required int64 cycle; required binary specimen (UTF8); }";

fn two_groups(path: &Path) {
    let text = |names: &[&str]| names.iter().map(|name| ByteArray::from(*name)).collect::<Vec<_>>();
    parquet(
        path,
        SCHEMA,
        &[
            &|group| {
                column::<DoubleType>(group, &[1.0, 1.0], None);
                column::<FloatType>(group, &[300.0, 290.0], None);
                column::<Int32Type>(group, &[50, 40], None);
                column::<DoubleType>(group, &[0.0, 0.5], Some(&[1, 1]));
                column::<Int64Type>(group, &[1, 1], None);
                column::<ByteArrayType>(group, &text(&["left", "left"]), None);
            },
            &|group| {
                column::<DoubleType>(group, &[2.0], None);
                column::<FloatType>(group, &[280.0], None);
                column::<Int32Type>(group, &[60], None);
                column::<DoubleType>(group, &[1.0], Some(&[1]));
                column::<Int64Type>(group, &[2], None);
                column::<ByteArrayType>(group, &text(&["right"]), None);
            },
        ],
    );
}

#[test]
fn parquet_reads_like_csv() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("data.parquet");
    two_groups(&path);
    let csv = Data::from_csv(&CSV.replace("60.5", "60"), "data.csv").unwrap();
    let found = Data::read(&[&path]).unwrap();
    assert_eq!(
        (found.pressure(), found.motion(), found.force()),
        (csv.pressure(), csv.motion(), csv.force())
    );
    assert_eq!(
        (found.time(), found.columns().cycle.as_deref()),
        (csv.time(), csv.columns().cycle.as_deref())
    );
    let rows = |data: &Data| (0..data.len()).map(|row| data.specimen_of(row)).collect::<Vec<u32>>();
    assert_eq!((rows(&found), found.specimens()), (rows(&csv), csv.specimens()));
    assert_eq!((found.line(2), csv.line(2)), ((0, 3), (0, 4)));
    // The first bytes decide, whatever the name.
    for name in ["data", "data.csv", "data.dat"] {
        let other = folder.path().join(name);
        std::fs::copy(&path, &other).unwrap();
        assert_eq!(Data::read(&[&other]).unwrap().force(), csv.force());
    }
    let bare = written(folder.path(), "rows.dat", CSV);
    assert_eq!(Data::read(&[&bare]).unwrap().len(), 3);
}

#[test]
fn parquet_defects_name_column_and_row() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("data.parquet");
    let says = |parts: &[&str]| {
        let message = Data::read(&[&path]).unwrap_err().to_string();
        for part in parts.iter().chain(&["data.parquet"]) {
            assert!(message.contains(part), "{message:?} does not say {part:?}");
        }
    };
    let three = "required double pressure[bar]; required double length[mm];";
    let fill = |force: &'static dyn Fn(&mut SerializedRowGroupWriter<'_, File>)| {
        move |group: &mut SerializedRowGroupWriter<'_, File>| {
            column::<DoubleType>(group, &[1.0, 2.0], None);
            column::<DoubleType>(group, &[300.0, 290.0], None);
            force(group);
        }
    };
    let schema = |force: &str| format!("message schema {{ {three} {force} }}");
    // A missing value, not a number, text in a number column.
    let missing = fill(&|group| column::<DoubleType>(group, &[5.0], Some(&[1, 0])));
    parquet(&path, &schema("optional double force[N];"), &[&missing]);
    says(&["1 of 2 rows", "`force[N]` is empty (row 2)"]);
    let nan = fill(&|group| column::<DoubleType>(group, &[5.0, f64::NAN], None));
    parquet(&path, &schema("required double force[N];"), &[&nan]);
    says(&["`force[N]` is not a finite number (row 2)"]);
    let text = fill(&|group| column::<ByteArrayType>(group, &["5".into(), "x5".into()], None));
    parquet(&path, &schema("required binary force[N] (UTF8);"), &[&text]);
    says(&["`force[N]` is not a number (row 2)"]);
    // Dates and decimals are stored as integers.
    let date = fill(&|group| column::<Int32Type>(group, &[5, 6], None));
    parquet(&path, &schema("required int32 force[N] (DATE);"), &[&date]);
    says(&["`force[N]`", "INT32 as Date:", "int64"]);
    let flag = fill(&|group| column::<BoolType>(group, &[true, false], None));
    parquet(&path, &schema("required boolean force[N];"), &[&flag]);
    says(&["`force[N]`", "the Parquet type BOOLEAN:"]);
    let bytes = fill(&|group| column::<ByteArrayType>(group, &[vec![0xff_u8].into(), "5".into()], None));
    parquet(&path, &schema("required binary force[N];"), &[&bytes]);
    says(&["`force[N]` is no text (row 1)"]);
    parquet(
        &path,
        &schema("required double weight[V];"),
        &[&fill(&|group| {
            column::<DoubleType>(group, &[5.0, 6.0], None);
        })],
    );
    says(&["no column `force`", "`weight[V]`", "--columns"]);
    parquet(&path, &schema("required double force[N];"), &[]);
    says(&["no row"]);
    std::fs::write(&path, "pressure [bar]\n").unwrap();
    says(&["can't be read as Parquet", "name it `.csv`"]);
    std::fs::write(&path, b"PAR1 and no end").unwrap();
    says(&["cut off or damaged", "write it again"]);
}

#[test]
fn several_files_are_one_analysis() {
    let folder = tempfile::tempdir().unwrap();
    let plain = "pressure [bar],length [mm],force [N],time [s]\n";
    let first = written(folder.path(), "first.csv", &format!("# lab\n{plain}1,300,50,0\n1,290,40,1\n"));
    let second =
        written(folder.path(), "second.csv", &format!("{plain}1,280,30,2\n1,270,20,3\n1,260,10,4\n"));
    let data = Data::read(&[&first, &second]).unwrap();
    assert_eq!(
        data.sweeps().iter().map(|s| (s.name.as_str(), s.rows.clone())).collect::<Vec<_>>(),
        [("first/1", 0..2), ("second/1", 2..5)]
    );
    assert_eq!((data.line(1), data.line(2), data.line(4)), ((0, 4), (1, 2), (1, 4)));
    assert_eq!(data.specimens(), ["1"]);
    assert_eq!(data.files().iter().map(|file| file.rows).collect::<Vec<_>>(), [2, 3]);
    let [one, two] = [&data.files()[0].sha256, &data.files()[1].sha256];
    assert!(one != two && one.len() == 64 && data.sha256().len() == 64);
    assert_eq!(Data::read(&[&first]).unwrap().sha256(), *one);
    // A subset keeps the line numbers of the file.
    assert_eq!(data.subset(&[false, true, false, true, true]).line(1), (1, 3));

    let copy = written(folder.path(), "copy.csv", &std::fs::read_to_string(&first).unwrap());
    let error = Data::read(&[&first, &copy]).unwrap_err();
    assert!(error.to_string().ends_with("copy.csv have the same content: name each file once"), "{error}");
    let other = written(folder.path(), "other.csv", CSV);
    let message = Data::read(&[&first, &other]).unwrap_err().to_string();
    assert!(message.contains("`cycle`") && message.contains("other.csv"), "{message}");
}

#[test]
fn unsigned_integers_of_parquet() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("data.parquet");
    let schema = "message schema { required double pressure[bar]; required double length[mm];
        required int32 force[N] (UINT_32); required int64 cycle (INTEGER(64,false)); }";
    let fill = |group: &mut SerializedRowGroupWriter<'_, File>| {
        column::<DoubleType>(group, &[1.0, 2.0], None);
        column::<DoubleType>(group, &[300.0, 290.0], None);
        column::<Int32Type>(group, &[5, -1], None);
        column::<Int64Type>(group, &[1, 7], None);
    };
    parquet(&path, schema, &[&fill]);
    let data = Data::read(&[&path]).unwrap();
    assert_eq!(
        (data.force(), data.columns().cycle.as_deref()),
        (&[5.0, f64::from(u32::MAX)][..], Some(&[1, 7][..]))
    );
}

#[test]
fn files_of_other_kinds() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, parts) in [
        ("data.xlsx", &b"PK\x03\x04\x14\0\x06\0"[..], ["Excel workbook", "save it as .xlsx"]),
        ("data.csv.gz", b"\x1f\x8b\x08\0", ["gzip", "unpack"]),
        ("data.mat", b"MATLAB 5.0 MAT-file", ["MATLAB", "save('x.mat','-v7')"]),
        ("data.feather", b"ARROW1\0\0", ["Feather", "Parquet"]),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let message = Data::read(&[&path]).unwrap_err().to_string();
        assert!(parts.iter().chain(&[name]).all(|part| message.contains(part)), "{message}");
    }
}

#[test]
fn files_that_can_not_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let none: [&Path; 0] = [];
    let message = Data::read(&none).unwrap_err().to_string();
    assert!(message.starts_with("no data file is given: name at least one file of CSV"), "{message}");
    let message = Data::read(&[folder.path().join("absent.csv")]).unwrap_err().to_string();
    assert!(message.contains("absent.csv: can't be read"), "{message}");
    let message = Data::read(&[folder.path()]).unwrap_err().to_string();
    assert!(message.contains("it is a folder"), "{message}");
    // A sparse file of more than 2 GiB is refused for its size before it is read.
    let huge = folder.path().join("huge.csv");
    File::create(&huge).unwrap().set_len((2 << 30) + 1).unwrap();
    let message = Data::read(&[&huge]).unwrap_err().to_string();
    assert!(message.contains("2147483649 bytes") && message.contains("2147483648"), "{message}");
}

/// M. Martens, I. Boblan: Modeling the Static Force of a Festo Pneumatic Muscle Actuator: A New Approach and a Comparison to Existing
/// Models, Actuators 6 (2017) 33, table A1 (CC BY 4.0).
#[test]
fn martens_boblan_2017_table_a1() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/dmsp-20-300/data.csv");
    if !std::path::Path::new(path).is_file() {
        println!("not tried: the measured force map is not beside the project");
        return;
    }
    let data = Data::read(&[path]).unwrap();
    assert_eq!((data.len(), data.sweeps().len(), data.sweeps()[0].kind), (66, 1, SweepKind::Static));
    assert_eq!((data.pressure()[0], data.force()[20], data.line(0)), (35e3, 1653.5, (0, 5)));
    assert!(matches!(data.motion(), Trace::Length(lengths) if lengths[65] == 0.222));
    let options = bulge_measurements::QualityOptions { l0_m: Some(0.3), radius_m: Some(0.01) };
    let quality = data.quality(&options);
    // The findings are free contractions only.
    assert!(quality.worst() <= Some(bulge_measurements::Severity::Note), "{quality:#?}");
    assert_eq!(quality.of(bulge_measurements::FindingKind::Slack).map(|found| found.count).sum::<usize>(), 6);
}
