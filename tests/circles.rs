//! No file of a crate may need a file that needs it: what two files share is a file below both.

#![allow(clippy::panic, clippy::unwrap_used, reason = "a test stops at the first surprise")]

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use syn::{Item, UseTree, visit::Visit};

/// A module's path within its crate: `["stages", "stats"]`; the crate's own file is the empty one.
type Module = Vec<String>;

#[derive(Default)]
struct File {
    path: PathBuf,
    defines: BTreeSet<String>,
    /// Where the names that it imports come from: `Found` from `["super", "outcomes", "Found"]`.
    imports: BTreeMap<String, Vec<String>>,
    /// Modules whose names it imports all.
    globs: Vec<Vec<String>>,
    /// Paths written out: `crate::tables::Table::read`.
    paths: Vec<Vec<String>>,
}

impl<'a> Visit<'a> for File {
    fn visit_path(&mut self, path: &'a syn::Path) {
        let words: Vec<String> = path.segments.iter().map(|s| s.ident.to_string()).collect();
        if matches!(words[0].as_str(), "crate" | "super") {
            self.paths.push(words);
        }
        syn::visit::visit_path(self, path);
    }

    fn visit_item_use(&mut self, item: &'a syn::ItemUse) {
        self.import(&mut Vec::new(), &item.tree);
    }

    fn visit_item_mod(&mut self, item: &'a syn::ItemMod) {
        let is_test = item.attrs.iter().any(|a| {
            let syn::Meta::List(list) = &a.meta else {
                return false;
            };
            a.path().is_ident("cfg") && list.tokens.to_string() == "test"
        });
        if !is_test {
            syn::visit::visit_item_mod(self, item);
        }
    }
}

impl File {
    fn read(path: PathBuf) -> Self {
        let text = std::fs::read_to_string(&path).unwrap();
        let parsed = syn::parse_file(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let defines = parsed.items.iter().filter_map(|item| {
            Some(match item {
                Item::Fn(i) => &i.sig.ident,
                Item::Struct(i) => &i.ident,
                Item::Enum(i) => &i.ident,
                Item::Trait(i) => &i.ident,
                Item::Type(i) => &i.ident,
                Item::Const(i) => &i.ident,
                Item::Static(i) => &i.ident,
                Item::Macro(i) => i.ident.as_ref()?,
                _ => return None,
            })
        });
        let defines = defines.map(ToString::to_string).collect();
        let mut file = Self { path, defines, ..Self::default() };
        file.visit_file(&parsed);
        file
    }

    fn import(&mut self, before: &mut Vec<String>, tree: &UseTree) {
        let whole = |before: &[String], last: &syn::Ident| {
            let mut path = before.to_vec();
            if last != "self" {
                path.push(last.to_string());
            }
            path
        };
        match tree {
            UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.import(before, &path.tree);
                before.pop();
            }
            UseTree::Group(group) => group.items.iter().for_each(|t| self.import(before, t)),
            UseTree::Glob(_) => self.globs.push(before.clone()),
            UseTree::Name(name) => {
                let path = whole(before, &name.ident);
                let last = path.last().cloned().unwrap_or_default();
                self.imports.insert(last, path);
            }
            UseTree::Rename(name) => {
                let path = whole(before, &name.ident);
                self.imports.insert(name.rename.to_string(), path);
            }
        }
    }
}

/// The files of a crate by module.
struct Crate(BTreeMap<Module, File>);

impl Crate {
    fn read(src: &Path) -> Self {
        let mut files = BTreeMap::new();
        let mut folders = vec![src.to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(&folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|e| e == "rs") {
                    let relative = path.strip_prefix(src).unwrap().with_extension("");
                    let mut module: Module =
                        relative.iter().map(|word| word.to_string_lossy().into_owned()).collect();
                    if matches!(module.last().unwrap().as_str(), "mod" | "lib" | "main") {
                        module.pop();
                    }
                    files.insert(module, File::read(path));
                }
            }
        }
        Self(files)
    }

    /// The module in which what `path` names, seen from `from`, is defined; re-exports are followed.
    fn home(&self, from: &Module, path: &[String], depth: usize) -> Option<Module> {
        let mut rest = path;
        let mut module = match path.first()?.as_str() {
            "crate" => Module::new(),
            _ => from.clone(),
        };
        while let Some((first, others)) = rest.split_first() {
            match first.as_str() {
                "crate" | "self" => {}
                "super" => drop(module.pop()),
                _ => break,
            }
            rest = others;
        }
        while let Some((first, others)) = rest.split_first() {
            let mut below = module.clone();
            below.push(first.clone());
            if !self.0.contains_key(&below) {
                break;
            }
            (module, rest) = (below, others);
        }
        let file = self.0.get(&module)?;
        let Some((name, after)) = rest.split_first() else {
            return Some(module);
        };
        if depth == 0 || file.defines.contains(name) {
            return Some(module);
        }
        let known = file.imports.get(name).map(|path| {
            let path: Vec<String> = path.iter().chain(after).cloned().collect();
            self.home(&module, &path, depth - 1)
        });
        let from_globs = || {
            file.globs.iter().find_map(|glob| {
                let there = self.home(&module, glob, depth - 1)?;
                self.0[&there].defines.contains(name).then_some(there)
            })
        };
        known.flatten().or_else(from_globs).or(Some(module))
    }

    /// Which modules each needs; what only re-exports needs none.
    fn needs(&self) -> BTreeMap<&Module, BTreeSet<Module>> {
        let of = |(module, file): (&Module, &File)| {
            let rooted = |path: &&Vec<String>| {
                matches!(path.first().map(String::as_str), Some("crate" | "super" | "self"))
            };
            let all = file.paths.iter().chain(file.imports.values());
            let all = all.chain(&file.globs).filter(rooted);
            let mut found: BTreeSet<Module> =
                all.filter_map(|path| self.home(module, path, 6)).collect();
            found.remove(module);
            found
        };
        self.0
            .iter()
            .map(|(module, file)| {
                let needed =
                    if file.defines.is_empty() { BTreeSet::new() } else { of((module, file)) };
                (module, needed)
            })
            .collect()
    }

    /// Groups of files that need each other.
    fn circles(&self) -> BTreeSet<BTreeSet<PathBuf>> {
        let needs = self.needs();
        let reached = |from: &Module| {
            let mut seen = BTreeSet::new();
            let mut todo: Vec<Module> = needs[from].iter().cloned().collect();
            while let Some(module) = todo.pop() {
                if seen.insert(module.clone()) {
                    todo.extend(needs[&module].iter().cloned());
                }
            }
            seen
        };
        let reach: BTreeMap<&Module, BTreeSet<Module>> =
            needs.keys().map(|m| (*m, reached(m))).collect();
        let circle = |module: &Module| -> BTreeSet<PathBuf> {
            let both = reach[module].iter().filter(|o| reach[*o].contains(module));
            both.map(|o| self.0[o].path.clone()).collect()
        };
        let mut found: BTreeSet<_> = reach.keys().map(|m| circle(m)).collect();
        found.retain(|group| group.len() > 1);
        found
    }
}

#[test]
fn no_files_of_a_crate_need_each_other() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut found = Vec::new();
    let mut read = 0;
    for entry in std::fs::read_dir(crates).unwrap() {
        let src = entry.unwrap().path().join("src");
        if src.is_dir() {
            let one = Crate::read(&src);
            read += one.0.len();
            for circle in one.circles() {
                let names: Vec<String> = circle.iter().map(|p| p.display().to_string()).collect();
                found.push(names.join("\n  "));
            }
        }
    }
    assert!(read > 300, "only {read} files were found");
    assert!(
        found.is_empty(),
        "files that need each other (put what they share in a file below both):\n\n  {}",
        found.join("\n\n  ")
    );
}

#[test]
fn a_circle_is_seen_through_a_re_export_and_not_in_what_only_re_exports() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    write("lib.rs", "mod a; mod b; pub use a::A; pub use b::B;");
    write("a.rs", "use crate::B; pub struct A(B);");
    write("b.rs", "pub struct B; impl B { fn a(self) {} }");
    assert!(Crate::read(folder.path()).circles().is_empty());
    write("b.rs", "pub struct B; fn b() { let _ = crate::A(B); }");
    assert_eq!(Crate::read(folder.path()).circles().len(), 1);
    write("b.rs", "pub struct B; #[cfg(test)] mod tests { use crate::A; }");
    assert!(Crate::read(folder.path()).circles().is_empty());
}
