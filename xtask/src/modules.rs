//! The modules of a crate and the paths that their code names, with re-exports followed to where an item is defined.
//!
//! Tests, comments and strings do not count; neither do attributes. The tokens of macros are searched for paths.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use proc_macro2::{Ident, TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{Attribute, ImplItem, Item, ItemMod, UseTree};

/// One module.
#[derive(Debug, Default)]
pub struct Module {
    pub name: String,
    pub parent: Option<usize>,
    names: BTreeMap<String, Vec<Name>>,
    globs: Vec<Vec<String>>,
}

/// What a name stands for inside a module; it may be more than one thing, as `solve` in `mod solve; use solve::solve;`.
#[derive(Clone, Debug, PartialEq)]
enum Name {
    /// A type, trait or macro.
    Item,
    /// A function, constant or static; nothing can stand behind it.
    Value,
    Module(usize),
    Import(Vec<String>),
}

/// A path that the code of a module names.
#[derive(Debug)]
pub struct Mention {
    pub module: usize,
    pub path: Vec<String>,
    pub file: String,
    pub line: usize,
    /// True for a `use`, where a single word may mean a module; in code it is a variable more often.
    declared: bool,
}

/// A crate; module 0 is its root.
#[derive(Debug, Default)]
pub struct Modules {
    pub modules: Vec<Module>,
    pub mentions: Vec<Mention>,
}

/// Where a path ends: a module, or an item defined in a module.
#[derive(Clone, Copy, PartialEq)]
enum End {
    Module(usize),
    Item(usize),
}

/// Ends of a path and the modules it goes through.
#[derive(Default)]
struct Walk {
    ends: Vec<End>,
    through: BTreeSet<usize>,
}

impl Walk {
    /// Adds another walk, if it led anywhere.
    fn add(&mut self, other: Walk) {
        if !other.ends.is_empty() {
            self.ends.extend(other.ends);
            self.through.extend(other.through);
        }
    }
}

impl Modules {
    /// Reads a crate from its root file; `text` gives the text of a file if there is one.
    pub fn read(root: &Path, text: &dyn Fn(&Path) -> Option<String>) -> Result<Self, String> {
        let mut reader = Reader { text, crate_: Self::default(), place: Place::default(), errors: Vec::new() };
        reader.file(root, "crate", None, root.parent().unwrap_or(root).to_path_buf());
        if reader.errors.is_empty() { Ok(reader.crate_) } else { Err(reader.errors.join("\n")) }
    }

    /// A module and all modules above it, from the root down.
    pub fn line(&self, module: usize) -> Vec<usize> {
        let mut line = self.modules[module].parent.map_or_else(Vec::new, |parent| self.line(parent));
        line.push(module);
        line
    }

    /// All modules that a path goes through, to the one that defines the item.
    pub fn reached(&self, mention: &Mention) -> BTreeSet<usize> {
        let walk = |path: &[String], whole| self.follow(mention.module, path, whole, &mut Vec::new());
        let is_item = |end: &End| matches!(end, End::Item(_));
        if !mention.declared {
            let first = walk(&mention.path[..1], mention.path.len() == 1);
            let imported = self.modules[mention.module].names.contains_key(&mention.path[0]);
            if imported && first.ends.iter().all(is_item) {
                // The `use` that brought the item counts already.
                return BTreeSet::new();
            }
            if mention.path.len() == 1 && !first.ends.iter().any(is_item) {
                return BTreeSet::new();
            }
        }
        walk(&mention.path, true).through
    }

    /// Follows a path; `whole` if no words stand behind it.
    fn follow<'p>(
        &'p self,
        from: usize,
        path: &'p [String],
        whole: bool,
        open: &mut Vec<(usize, &'p [String])>,
    ) -> Walk {
        if open.contains(&(from, path)) {
            return Walk::default();
        }
        open.push((from, path));
        let mut walk = Walk { ends: vec![End::Module(from)], ..Walk::default() };
        for (position, word) in path.iter().enumerate() {
            let last = whole && position + 1 == path.len();
            let mut next = Walk::default();
            for end in &walk.ends {
                match end {
                    // Behind an item stand its own names: variants, functions.
                    End::Item(_) => next.ends.push(*end),
                    End::Module(at) => next.add(self.step(*at, word, last, open)),
                }
            }
            walk.ends = next.ends;
            walk.through.append(&mut next.through);
        }
        open.pop();
        walk
    }

    fn step<'p>(&'p self, at: usize, word: &'p str, last: bool, open: &mut Vec<(usize, &'p [String])>) -> Walk {
        let to = |end: End, at: usize| Walk { ends: vec![end], through: BTreeSet::from([at]) };
        let module = &self.modules[at];
        match word {
            "crate" => return to(End::Module(0), 0),
            "self" => return to(End::Module(at), at),
            "super" => return module.parent.map_or_else(Walk::default, |parent| to(End::Module(parent), parent)),
            _ => {}
        }
        let mut walk = Walk::default();
        let names = module.names.get(word);
        for name in names.into_iter().flatten() {
            walk.add(match name {
                Name::Value if !last => Walk::default(),
                Name::Item | Name::Value => to(End::Item(at), at),
                Name::Module(child) => to(End::Module(*child), *child),
                Name::Import(path) => self.follow(at, path, last, open),
            });
        }
        if names.is_none() {
            for glob in &module.globs {
                let source = self.follow(at, glob, false, open);
                for end in &source.ends {
                    let End::Module(other) = *end else { continue };
                    // A name is looked for once in each module, so that globs may go both ways.
                    if other != at && !open.iter().any(|(seen, path)| *seen == other && path.is_empty()) {
                        open.push((at, &[]));
                        let mut found = self.step(other, word, last, open);
                        open.pop();
                        found.through.extend(&source.through);
                        walk.add(found);
                    }
                }
            }
        }
        walk
    }
}

/// Where the reader is.
#[derive(Clone, Default)]
struct Place {
    module: usize,
    file: PathBuf,
    /// Folder of the files of the module's children.
    folder: PathBuf,
    /// True inside of a function or another item.
    inside: bool,
}

struct Reader<'t> {
    text: &'t dyn Fn(&Path) -> Option<String>,
    crate_: Modules,
    place: Place,
    errors: Vec<String>,
}

impl Reader<'_> {
    /// Reads a module from its own file.
    fn file(&mut self, file: &Path, name: &str, parent: Option<usize>, folder: PathBuf) {
        let Some(text) = (self.text)(file) else {
            self.errors.push(format!("{}: no such file", file.display()));
            return;
        };
        match syn::parse_file(&text) {
            Ok(parsed) => self.module(&parsed.items, name, parent, file.to_path_buf(), folder),
            Err(error) => {
                self.errors.push(format!("{}:{}: {error}", file.display(), error.span().start().line));
            }
        }
    }

    fn module(&mut self, items: &[Item], name: &str, parent: Option<usize>, file: PathBuf, folder: PathBuf) {
        let module = self.crate_.modules.len();
        self.crate_.modules.push(Module { name: name.to_owned(), parent, ..Module::default() });
        if let Some(parent) = parent {
            self.define(parent, name, Name::Module(module));
        }
        let outer = std::mem::replace(&mut self.place, Place { module, file, folder, inside: false });
        items.iter().for_each(|item| self.visit_item(item));
        self.place = outer;
    }

    /// A child of the module at hand, in place or in its own file.
    fn child(&mut self, item: &ItemMod) {
        let (name, parent, folder) = (plain(&item.ident), self.place.module, self.place.folder.clone());
        if let Some((_, items)) = &item.content {
            return self.module(items, &name, Some(parent), self.place.file.clone(), folder.join(&name));
        }
        if let Some(path) = path_attribute(&item.attrs) {
            let file = self.place.file.with_file_name(path);
            let folder = file.parent().unwrap_or(&file).to_path_buf();
            return self.file(&file, &name, Some(parent), folder);
        }
        let (flat, nested) = (folder.join(format!("{name}.rs")), folder.join(&name).join("mod.rs"));
        let file = if (self.text)(&flat).is_some() { flat } else { nested };
        self.file(&file, &name, Some(parent), folder.join(&name));
    }

    fn define(&mut self, module: usize, name: &str, meaning: Name) {
        let names = self.crate_.modules[module].names.entry(name.to_owned()).or_default();
        if !names.contains(&meaning) {
            names.push(meaning);
        }
    }

    fn mention(&mut self, path: Vec<String>, at: &Ident, declared: bool) {
        let (module, file) = (self.place.module, self.place.file.display().to_string());
        self.crate_.mentions.push(Mention { module, path, file, line: at.span().start().line, declared });
    }

    fn import(&mut self, before: &[String], tree: &UseTree) {
        let join = |ident: &Ident| before.iter().cloned().chain([plain(ident)]).collect::<Vec<_>>();
        let (ident, name) = match tree {
            UseTree::Path(path) => {
                if matches!(*path.tree, UseTree::Glob(_)) {
                    self.mention(join(&path.ident), &path.ident, true);
                }
                return self.import(&join(&path.ident), &path.tree);
            }
            UseTree::Group(group) => return group.items.iter().for_each(|item| self.import(before, item)),
            UseTree::Glob(_) => return self.crate_.modules[self.place.module].globs.push(before.to_vec()),
            UseTree::Name(name) => (&name.ident, &name.ident),
            UseTree::Rename(rename) => (&rename.ident, &rename.rename),
        };
        let mut path = join(ident);
        let mut name = plain(name);
        if path.len() > 1 && ident == "self" {
            path.pop();
            if name == "self" {
                name = path[path.len() - 1].clone();
            }
        }
        self.mention(path.clone(), ident, true);
        self.define(self.place.module, &name, Name::Import(path));
    }

    /// Paths among the tokens of a macro.
    fn tokens(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let mut start = None;
        let mut colons = 0;
        for token in tokens {
            match &token {
                TokenTree::Punct(punct) if punct.as_char() == ':' => {
                    colons += 1;
                    continue;
                }
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.end_of_path(&mut path, &mut start);
                    }
                    path.push(plain(ident));
                    start.get_or_insert_with(|| ident.clone());
                }
                _ => self.end_of_path(&mut path, &mut start),
            }
            colons = 0;
            if let TokenTree::Group(group) = token {
                self.tokens(group.stream());
            }
        }
        self.end_of_path(&mut path, &mut start);
    }

    fn end_of_path(&mut self, path: &mut Vec<String>, start: &mut Option<Ident>) {
        if let Some(start) = start.take() {
            self.mention(std::mem::take(path), &start, false);
        }
    }
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        let (attributes, ident) = head(item);
        if attributes.iter().any(is_test) {
            return;
        }
        match item {
            Item::Mod(child) => return self.child(child),
            Item::Use(declaration) => return self.import(&[], &declaration.tree),
            _ => {}
        }
        if let (Some(ident), false) = (ident, self.place.inside) {
            let value = matches!(item, Item::Const(_) | Item::Fn(_) | Item::Static(_));
            self.define(self.place.module, &plain(ident), if value { Name::Value } else { Name::Item });
        }
        let outer = std::mem::replace(&mut self.place.inside, true);
        visit::visit_item(self, item);
        self.place.inside = outer;
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        let attributes = match item {
            ImplItem::Const(item) => item.attrs.as_slice(),
            ImplItem::Fn(item) => &item.attrs,
            ImplItem::Type(item) => &item.attrs,
            _ => &[],
        };
        if !attributes.iter().any(is_test) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if let (Some(first), None) = (path.segments.first(), &path.leading_colon) {
            let words = path.segments.iter().map(|segment| plain(&segment.ident)).collect();
            self.mention(words, &first.ident, false);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        visit::visit_macro(self, call);
        self.tokens(call.tokens.clone());
    }

    fn visit_attribute(&mut self, _: &'ast Attribute) {}
}

/// Attributes and name of an item.
fn head(item: &Item) -> (&[Attribute], Option<&Ident>) {
    match item {
        Item::Const(item) => (&item.attrs, Some(&item.ident)),
        Item::Enum(item) => (&item.attrs, Some(&item.ident)),
        Item::Fn(item) => (&item.attrs, Some(&item.sig.ident)),
        Item::Macro(item) => (&item.attrs, item.ident.as_ref()),
        Item::Static(item) => (&item.attrs, Some(&item.ident)),
        Item::Struct(item) => (&item.attrs, Some(&item.ident)),
        Item::Trait(item) => (&item.attrs, Some(&item.ident)),
        Item::Type(item) => (&item.attrs, Some(&item.ident)),
        Item::Union(item) => (&item.attrs, Some(&item.ident)),
        Item::Impl(item) => (&item.attrs, None),
        Item::Mod(item) => (&item.attrs, None),
        Item::Use(item) => (&item.attrs, None),
        _ => (&[], None),
    }
}

/// A name without the `r#` of a raw one.
fn plain(ident: &Ident) -> String {
    ident.to_string().trim_start_matches("r#").to_owned()
}

/// True for `#[cfg(test)]` and `#[cfg(all(test, ...))]`.
fn is_test(attribute: &Attribute) -> bool {
    let Ok(list) = attribute.meta.require_list() else { return false };
    let text = list.tokens.to_string();
    let words: Vec<&str> = text.split(|symbol: char| !symbol.is_alphanumeric() && symbol != '_').collect();
    list.path.is_ident("cfg") && words.contains(&"test") && !words.contains(&"not") && !words.contains(&"any")
}

fn path_attribute(attributes: &[Attribute]) -> Option<String> {
    let found = attributes.iter().find(|attribute| attribute.path().is_ident("path"))?;
    let syn::Expr::Lit(value) = &found.meta.require_name_value().ok()?.value else { return None };
    if let syn::Lit::Str(text) = &value.lit { Some(text.value()) } else { None }
}
