//! The pages: README stays a front page, every relative link of it and of `docs/` leads to a file (and to a heading, where it names one), and the book's index
//! leads to every page.

use super::root;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Bytes of README.md: two printed pages and their tables.
const MOST_BYTES: u64 = 12_000;

/// Lines with their numbers, those of fenced code left out.
fn unfenced(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut fenced = false;
    (1..).zip(text.lines()).filter(move |(_, line)| {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        !fenced && !fence
    })
}

/// Targets of `[text](target)` and `![text](target)` with their lines. What stands in code is no link; a span of code ends with its paragraph at the latest.
fn links(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut code = false;
    for (number, line) in unfenced(text) {
        code &= !line.trim().is_empty();
        let mut prose = String::new();
        for c in line.chars() {
            code ^= c == '`';
            if !code {
                prose.push(c);
            }
        }
        // Of `(target "title")` the target.
        let targets = prose.split("](").skip(1).filter_map(|rest| rest.split([')', ' ']).next());
        found.extend(targets.map(|target| (number, target.to_owned())));
    }
    found
}

/// Anchors of the headings, as GitHub makes them.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (_, line) in unfenced(text) {
        let title = line.trim_start_matches('#');
        if title.len() == line.len() || !title.starts_with(' ') {
            continue;
        }
        let anchor: String = title
            .trim()
            .to_lowercase()
            .chars()
            .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'))
            .map(|c| if c == ' ' { '-' } else { c })
            .collect();
        // The second of a name is name-1.
        let again = (1..).map(|n| format!("{anchor}-{n}"));
        let free = std::iter::once(anchor.clone()).chain(again).find(|name| !found.contains(name));
        found.extend(free);
    }
    found
}

/// `docs/../README.md` is `README.md`. None leads out of the repository.
fn normal(path: &Path) -> Option<PathBuf> {
    let mut parts = PathBuf::new();
    for part in path.components() {
        match part {
            Component::Normal(name) => parts.push(name),
            Component::ParentDir => parts.pop().then_some(())?,
            Component::CurDir => {}
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(parts)
}

/// Where a target leads: a path from the root and an anchor (empty if it names none). `None`: to another site.
fn leads_to(page: &str, target: &str) -> Option<(PathBuf, String)> {
    if target.contains("://") || target.starts_with("mailto:") {
        return None;
    }
    let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
    let folder = Path::new(page).parent().unwrap_or(Path::new(""));
    let path = if path.is_empty() { PathBuf::from(page) } else { folder.join(path) };
    Some((path, anchor.to_owned()))
}

/// Links of a page that lead nowhere.
fn broken(root: &Path, page: &str, text: &str) -> Vec<String> {
    let mut complaints = Vec::new();
    for (line, target) in links(text) {
        let Some((path, anchor)) = leads_to(page, &target) else { continue };
        let here = normal(&path).map(|path| root.join(path)).filter(|path| path.exists());
        let Some(file) = here else {
            complaints
                .push(format!("{page}:{line} links to `{target}`: there is no such file in the repository"));
            continue;
        };
        if anchor.is_empty() {
            continue;
        }
        let headings = anchors(&fs::read_to_string(&file).unwrap_or_default());
        if !headings.contains(&anchor) {
            complaints.push(format!(
                "{page}:{line} links to `{target}`: its headings have the anchors {headings:?}"
            ));
        }
    }
    complaints
}

/// README.md and every page of the book, by path from the root.
fn pages() -> Vec<String> {
    let mut found = vec!["README.md".to_owned()];
    let mut folders = vec![root().join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                found.push(path.strip_prefix(root()).unwrap().to_string_lossy().replace('\\', "/"));
            }
        }
    }
    found.sort();
    found
}

#[test]
fn the_front_page_is_short() {
    let bytes = fs::metadata(root().join("README.md")).unwrap().len();
    assert!(bytes < MOST_BYTES, "README.md has {bytes} bytes, {MOST_BYTES} at most: move what grew to docs/");
}

#[test]
fn links_lead_somewhere() {
    let pages = pages();
    assert!(pages.len() > 10, "found only {pages:?}");
    let complaints: Vec<String> = pages
        .iter()
        .flat_map(|page| broken(&root(), page, &fs::read_to_string(root().join(page)).unwrap()))
        .collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn the_index_leads_to_every_page() {
    const INDEX: &str = "docs/README.md";
    let text = fs::read_to_string(root().join(INDEX)).unwrap();
    let listed: BTreeSet<PathBuf> =
        links(&text).iter().filter_map(|(_, target)| normal(&leads_to(INDEX, target)?.0)).collect();
    for page in pages().iter().filter(|page| *page != INDEX) {
        assert!(listed.contains(Path::new(page)), "{INDEX} doesn't list {page}");
    }
}

#[test]
fn bad_links_are_caught() {
    let folder = root();
    let page = "# One, two: `three`\n\n## Twice\n\n## Twice\n\n```sh\n# no heading [x](nowhere.md)\n```\n";
    let good = "[a](#one-two-three) [b](#twice-1) ![c](../README.md) [d](https://example.org/x#y) `[e](nowhere.md)` `over\ntwo [f](nowhere.md)`\n";
    assert_eq!(
        anchors(page).into_iter().collect::<Vec<_>>(),
        ["one-two-three", "twice", "twice-1"],
        "headings of a sample"
    );
    // Anchors of the page itself are those of the file on the disk: only links are tried here.
    let elsewhere: Vec<_> = links(good).into_iter().map(|(_, target)| target).collect();
    assert_eq!(elsewhere, ["#one-two-three", "#twice-1", "../README.md", "https://example.org/x#y"]);
    assert!(broken(&folder, "docs/a.md", page).is_empty());
    for (text, part) in [
        ("\n[a](nowhere.md)", "a.md:2 links to `nowhere.md`"),
        ("![a](../crates/nothing.png \"title\")", "`../crates/nothing.png`"),
        ("[a](README.md#bulge)", "its headings have the anchors"),
        ("[a](../../README.md)", "no such file in the repository"),
        ("[a](/README.md)", "no such file in the repository"),
        ("`code` [a](nowhere.md)", "`nowhere.md`"),
        ("`open\n\n[a](nowhere.md)", "a.md:3"),
    ] {
        let complaints = broken(&folder, "docs/a.md", text).join("\n");
        assert!(complaints.contains(part), "{text:?}: {complaints:?} does not say {part:?}");
    }
}
