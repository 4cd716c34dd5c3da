//! Pages of the documentation taken apart: code blocks, generated parts, links.

use std::fs;
use std::path::{Path, PathBuf};

pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

#[derive(Debug)]
pub struct Page {
    pub path: PathBuf,
    pub text: String,
}

/// A fenced code block.
#[derive(Debug)]
pub struct Block {
    /// Words after the opening fence: `fp`, `fails`.
    pub info: Vec<String>,
    pub text: String,
    /// Line of the opening fence, from 1.
    pub line: usize,
}

/// The README and every page below `docs`.
pub fn pages() -> Vec<Page> {
    let mut paths: Vec<PathBuf> = fs::read_dir(root().join("docs"))
        .expect("a folder")
        .map(|entry| entry.expect("readable").path())
        .collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    paths.push(root().join("README.md"));
    paths.push(root().join("examples/README.md"));
    paths.sort();
    paths
        .into_iter()
        .map(|path| Page { text: fs::read_to_string(&path).expect("a readable page"), path })
        .collect()
}

impl Page {
    pub fn name(&self) -> String {
        self.path.strip_prefix(root()).unwrap_or(&self.path).display().to_string()
    }

    /// Code blocks in order; a block indented in a list counts too, without its indentation.
    pub fn blocks(&self) -> Vec<Block> {
        let mut blocks = Vec::new();
        let mut open: Option<(Block, usize)> = None;
        for (number, line) in self.text.lines().enumerate() {
            let fence = line.trim_start().strip_prefix("```");
            match (&mut open, fence) {
                (None, Some(info)) => {
                    let info = info.split_whitespace().map(str::to_string).collect();
                    open = Some((
                        Block { info, text: String::new(), line: number + 1 },
                        line.len() - line.trim_start().len(),
                    ));
                }
                (Some(_), Some("")) => blocks.extend(open.take().map(|(block, _)| block)),
                (Some((block, indent)), _) => {
                    block.text += line.get(*indent..).unwrap_or("");
                    block.text.push('\n');
                }
                (None, None) => {}
            }
        }
        assert!(open.is_none(), "{}: a code block does not end", self.name());
        blocks
    }

    /// The text outside code blocks.
    pub fn prose(&self) -> String {
        let mut inside = false;
        let outside = |line: &&str| {
            let fence = line.trim_start().starts_with("```");
            inside ^= fence;
            !inside && !fence
        };
        self.text.lines().filter(outside).collect::<Vec<_>>().join("\n")
    }

    /// The page with the parts between `<!-- generated: name -->` and `<!-- end -->` made anew.
    pub fn regenerated(&self, part: impl Fn(&str) -> String) -> String {
        let mut out = String::new();
        let mut rest = self.text.as_str();
        while let Some((before, after)) = rest.split_once("<!-- generated: ") {
            let (name, after) = after
                .split_once(" -->\n")
                .unwrap_or_else(|| panic!("{}: a mark does not end", self.name()));
            let (_, after) = after
                .split_once("<!-- end -->")
                .unwrap_or_else(|| panic!("{}: part `{name}` does not end", self.name()));
            out += &format!("{before}<!-- generated: {name} -->\n{}<!-- end -->", part(name));
            rest = after;
        }
        out + rest
    }

    /// The page with the code block after each block that has an answer holding that answer.
    pub fn with_answers(&self, mut answer: impl FnMut(&Block) -> Option<String>) -> String {
        let mut lines: Vec<String> = self.text.lines().map(|line| format!("{line}\n")).collect();
        let blocks = self.blocks();
        for pair in blocks.windows(2) {
            if let Some(text) = answer(&pair[0]) {
                let inside = pair[1].line..pair[1].line + pair[1].text.lines().count();
                lines[inside.clone()].fill(String::new());
                // An empty block has no line of its own to stand in.
                lines[pair[1].line - 1] += &text;
            }
        }
        lines.concat()
    }

    pub fn generated(&self) -> Vec<String> {
        self.text
            .split("<!-- generated: ")
            .skip(1)
            .filter_map(|after| Some(after.split_once(" -->")?.0.to_string()))
            .collect()
    }

    /// Targets of links and images to files of the repository.
    pub fn links(&self) -> Vec<String> {
        let prose = self.prose();
        let of_links = prose
            .split("](")
            .skip(1)
            .filter_map(|after| after.split_once(')'))
            .map(|(target, _)| target);
        let of_images = prose
            .split("src=\"")
            .skip(1)
            .filter_map(|after| after.split_once('"'))
            .map(|(target, _)| target);
        of_links
            .chain(of_images)
            .filter(|target| !target.contains("://"))
            .map(str::to_string)
            .collect()
    }

    /// The anchors that headings have on the usual hosts.
    pub fn anchors(&self) -> Vec<String> {
        let headings = self.prose();
        let headings = headings
            .lines()
            .filter(|line| line.starts_with('#'))
            .map(|line| line.trim_start_matches('#').trim().to_lowercase());
        headings
            .map(|heading| {
                let kept =
                    heading.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
                kept.map(|c| if c == ' ' { '-' } else { c }).collect()
            })
            .collect()
    }
}

/// A path beside a page, without `..`.
pub fn beside(page: &Path, target: &str) -> PathBuf {
    let mut path = page.parent().unwrap_or(Path::new("")).to_path_buf();
    for part in target.split('/') {
        match part {
            ".." => drop(path.pop()),
            "." | "" => {}
            part => path.push(part),
        }
    }
    path
}
