//! A file of the dialect: its syntax tree, and the comments that the tree does not hold.

use proc_macro2::Span;

/// One parsed file.
pub(crate) struct Unit {
    /// Its path, for messages.
    pub(crate) name: String,
    pub(crate) items: Vec<syn::Item>,
    /// What a `Real` is in C.
    pub(crate) real: &'static str,
    comments: Vec<(usize, String)>,
}

impl Unit {
    /// Parses a file of the dialect.
    pub(crate) fn parse(name: &str, text: &str) -> Result<Self, String> {
        let file =
            syn::parse_file(text).map_err(|error| format!("{name} line {}: {error}", error.span().start().line))?;
        let comments = text.lines().zip(1..).filter_map(|(line, number)| {
            let comment = line.trim_start().strip_prefix("//")?;
            // What begins with a third slash or an exclamation mark is documentation, and in the tree.
            (!comment.starts_with(['/', '!'])).then(|| (number, comment.trim().to_owned()))
        });
        Ok(Self { name: name.to_owned(), items: file.items, real: "real", comments: comments.collect() })
    }

    /// The comments that stand on lines of their own after line `after` and before line `before`.
    pub(crate) fn comments_between(&self, after: usize, before: usize) -> impl Iterator<Item = &str> {
        self.comments.iter().filter(move |(line, _)| (after..before).contains(line)).map(|(_, text)| text.as_str())
    }

    /// The name of its module.
    pub(crate) fn module(&self) -> &str {
        self.name.rsplit('/').next().unwrap_or_default().trim_end_matches(".rs")
    }

    /// An error at a place of this file.
    pub(crate) fn error<T>(&self, span: Span, what: &str) -> Result<T, String> {
        Err(format!("{} line {}: the dialect has no {what}", self.name, span.start().line))
    }
}

/// The name that an item takes in C, if it is one of the dialect's.
pub(crate) fn name_of(item: &syn::Item) -> Option<&syn::Ident> {
    match item {
        syn::Item::Const(item) => Some(&item.ident),
        syn::Item::Struct(item) if is_of_numbers(&item.generics) => Some(&item.ident),
        syn::Item::Fn(item) => Some(&item.sig.ident),
        _ => None,
    }
}

/// Whether an item is generic over nothing but `Real`, what a number is.
pub(crate) fn is_of_numbers(generics: &syn::Generics) -> bool {
    generics.params.iter().all(|param| matches!(param, syn::GenericParam::Type(ty) if ty.ident == "Real"))
}
