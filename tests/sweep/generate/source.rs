//! The public items of the library, by their source.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use quote::ToTokens;
use syn::{Attribute, FnArg, ImplItem, Item, ReturnType, Type, UseTree, Visibility};

/// Private path of a module, from the crate's root.
type Module = Vec<String>;

/// The library.
#[derive(Default)]
pub(crate) struct Crate {
    /// Public path of each public structure or enumeration, by its name: no two share one.
    pub(crate) types: BTreeMap<String, String>,
    /// Their definitions.
    pub(crate) definitions: BTreeMap<String, Item>,
    /// Types with `Default`.
    pub(crate) defaults: BTreeSet<String>,
    pub(crate) functions: Vec<Function>,
}

/// A public function or method.
pub(crate) struct Function {
    /// Public path with its name.
    pub(crate) path: String,
    /// The type that it is a method of.
    pub(crate) of: Option<String>,
    pub(crate) inputs: Vec<FnArg>,
    pub(crate) output: ReturnType,
    /// Whether it or its type has parameters of types, constants or lifetimes that a call has to give.
    pub(crate) generic: bool,
    /// Whether its documentation has a section `Panics`.
    pub(crate) panics: bool,
}

/// Reads all files.
pub(crate) fn read(folder: &Path) -> Crate {
    let mut modules = BTreeMap::new();
    read_module(&folder.join("lib.rs"), folder, &Vec::new(), &mut modules);
    let mut found = Crate::default();
    let mut free = Vec::new();
    exports(&Vec::new(), "roverlab", &modules, &mut found, &mut free, &mut BTreeSet::new());
    for (path, function) in free {
        found.functions.push(function_of(path, None, &function.sig, &function.attrs, false));
    }
    for items in modules.values() {
        for item in items {
            if let Item::Impl(block) = item {
                methods(block, &mut found);
            }
        }
    }
    found.functions.sort_by(|a, b| a.path.cmp(&b.path));
    found
}

fn read_module(file: &Path, folder: &Path, module: &Module, modules: &mut BTreeMap<Module, Vec<Item>>) {
    let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let parsed = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    add(parsed.items, folder, module, modules);
}

fn add(items: Vec<Item>, folder: &Path, module: &Module, modules: &mut BTreeMap<Module, Vec<Item>>) {
    let items: Vec<Item> = items.into_iter().filter(|item| !is_test(item)).collect();
    for item in &items {
        let Item::Mod(inner) = item else { continue };
        let name = inner.ident.to_string();
        let path: Module = module.iter().cloned().chain([name.clone()]).collect();
        let below = folder.join(&name);
        if let Some((_, content)) = &inner.content {
            add(content.clone(), &below, &path, modules);
            continue;
        }
        let candidates: [PathBuf; 2] = [folder.join(format!("{name}.rs")), below.join("mod.rs")];
        if let Some(file) = candidates.iter().find(|file| file.exists()) {
            read_module(file, &below, &path, modules);
        }
    }
    modules.insert(module.clone(), items);
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Mod(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

fn is_test(item: &Item) -> bool {
    let is_cfg_test = |attribute: &Attribute| {
        attribute.path().is_ident("cfg") && attribute.to_token_stream().to_string().contains("(test)")
    };
    attributes(item).iter().any(is_cfg_test)
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

type Free = Vec<(String, syn::ItemFn)>;

/// Walks the public modules and what they export.
fn exports(
    module: &Module,
    public: &str,
    modules: &BTreeMap<Module, Vec<Item>>,
    found: &mut Crate,
    free: &mut Free,
    seen: &mut BTreeSet<String>,
) {
    for item in modules.get(module).into_iter().flatten() {
        match item {
            Item::Mod(inner) if is_public(&inner.vis) => {
                let name = inner.ident.to_string();
                let path: Module = module.iter().cloned().chain([name.clone()]).collect();
                exports(&path, &format!("{public}::{name}"), modules, found, free, seen);
            }
            Item::Use(import) if is_public(&import.vis) => {
                for (path, name) in leaves(&import.tree, Vec::new()) {
                    if let Some(item) = resolve(module, &path, modules, 0) {
                        export(item, &format!("{public}::{name}"), &name, found, free, seen);
                    }
                }
            }
            item => {
                if let Some(name) = name_of(item) {
                    export(item, &format!("{public}::{name}"), &name, found, free, seen);
                }
            }
        }
    }
}

/// The name of a public item.
fn name_of(item: &Item) -> Option<String> {
    let (visibility, name) = match item {
        Item::Fn(item) => (&item.vis, &item.sig.ident),
        Item::Struct(item) => (&item.vis, &item.ident),
        Item::Enum(item) => (&item.vis, &item.ident),
        _ => return None,
    };
    is_public(visibility).then(|| name.to_string())
}

fn export(
    item: &Item,
    path: &str,
    name: &str,
    found: &mut Crate,
    free: &mut Free,
    seen: &mut BTreeSet<String>,
) {
    if !seen.insert(path.to_owned()) {
        return;
    }
    if let Item::Fn(function) = item {
        free.push((path.to_owned(), function.clone()));
    } else {
        found.types.entry(name.to_owned()).or_insert_with(|| path.to_owned());
        let derives = attributes(item).iter().any(|attribute| {
            attribute.path().is_ident("derive") && attribute.to_token_stream().to_string().contains("Default")
        });
        if derives {
            found.defaults.insert(name.to_owned());
        }
        found.definitions.insert(name.to_owned(), item.clone());
    }
}

/// The paths that an import names, with the names that it gives.
fn leaves(tree: &UseTree, mut path: Vec<String>) -> Vec<(Vec<String>, String)> {
    match tree {
        UseTree::Path(inner) => {
            path.push(inner.ident.to_string());
            leaves(&inner.tree, path)
        }
        UseTree::Name(inner) => {
            path.push(inner.ident.to_string());
            vec![(path, inner.ident.to_string())]
        }
        UseTree::Rename(inner) => {
            path.push(inner.ident.to_string());
            vec![(path, inner.rename.to_string())]
        }
        UseTree::Group(group) => group.items.iter().flat_map(|tree| leaves(tree, path.clone())).collect(),
        UseTree::Glob(_) => Vec::new(),
    }
}

/// The item at a path, as seen from a module.
fn resolve<'a>(
    module: &Module,
    path: &[String],
    modules: &'a BTreeMap<Module, Vec<Item>>,
    depth: usize,
) -> Option<&'a Item> {
    let (name, folders) = path.split_last()?;
    let mut at = module.clone();
    for folder in folders {
        match folder.as_str() {
            "crate" => at.clear(),
            "self" => {}
            "super" => {
                at.pop();
            }
            _ => at.push(folder.clone()),
        }
    }
    let items = modules.get(&at)?;
    let own = items.iter().find(|item| name_of(item).is_some_and(|other| other == *name));
    own.or_else(|| {
        let imports =
            items.iter().filter_map(|item| if let Item::Use(import) = item { Some(import) } else { None });
        let mut again = imports
            .flat_map(|import| leaves(&import.tree, Vec::new()))
            .filter(|(_, other)| other == name)
            .map(|(path, _)| path);
        (depth < 8).then(|| again.find_map(|path| resolve(&at, &path, modules, depth + 1)))?
    })
}

fn methods(block: &syn::ItemImpl, found: &mut Crate) {
    let Type::Path(of) = &*block.self_ty else { return };
    let Some(last) = of.path.segments.last() else { return };
    let name = last.ident.to_string();
    let Some(path) = found.types.get(&name).cloned() else { return };
    if let Some((_, implemented, _)) = &block.trait_ {
        if implemented.is_ident("Default") {
            found.defaults.insert(name);
        }
        return;
    }
    let generic = !last.arguments.is_empty() && last.arguments.to_token_stream().to_string() != "< '_ >";
    for item in &block.items {
        if let ImplItem::Fn(function) = item
            && is_public(&function.vis)
        {
            let path = format!("{path}::{}", function.sig.ident);
            found.functions.push(function_of(
                path,
                Some(name.clone()),
                &function.sig,
                &function.attrs,
                generic,
            ));
        }
    }
}

fn function_of(
    path: String,
    of: Option<String>,
    sig: &syn::Signature,
    attributes: &[Attribute],
    generic: bool,
) -> Function {
    let documentation: String =
        attributes.iter().map(|attribute| attribute.to_token_stream().to_string()).collect();
    let types = sig.generics.type_params().count() + sig.generics.const_params().count();
    Function {
        path,
        of,
        inputs: sig.inputs.iter().cloned().collect(),
        output: sig.output.clone(),
        generic: generic || types > 0,
        panics: documentation.contains("# Panics"),
    }
}
