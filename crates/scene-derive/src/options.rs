//! Options of the macro's attributes: `flag` or `name = value`, separated by commas.

use proc_macro2::TokenStream;
use quote::quote;
use syn::parse::ParseStream;
use syn::punctuated::Punctuated;
use syn::{Attribute, Expr, ExprLit, Lit, Meta, Token, Type};

/// Options of a type or of a field.
#[derive(Default)]
pub(crate) struct Options(Vec<Meta>);

/// The options between the parentheses of an attribute.
pub(crate) fn parse(input: ParseStream<'_>) -> syn::Result<Options> {
    Ok(Options(Punctuated::<Meta, Token![,]>::parse_terminated(input)?.into_iter().collect()))
}

impl Options {
    /// The options of the attribute `#[key(...)]` among these attributes, which is removed.
    pub(crate) fn take(attributes: &mut Vec<Attribute>) -> syn::Result<Self> {
        let Some(at) = attributes.iter().position(|attribute| attribute.path().is_ident("key")) else {
            return Ok(Self::default());
        };
        attributes.remove(at).parse_args_with(parse)
    }

    /// Whether a flag is there.
    pub(crate) fn has(&self, flag: &str) -> bool {
        self.0.iter().any(|option| matches!(option, Meta::Path(path) if path.is_ident(flag)))
    }

    /// Value of an option.
    pub(crate) fn value(&self, name: &str) -> Option<&Expr> {
        self.0.iter().find_map(|option| match option {
            Meta::NameValue(pair) if pair.path.is_ident(name) => Some(&pair.value),
            _ => None,
        })
    }

    /// Value of an option that is a string.
    pub(crate) fn text(&self, name: &str) -> syn::Result<Option<String>> {
        match self.value(name) {
            Some(Expr::Lit(ExprLit { lit: Lit::Str(text), .. })) => Ok(Some(text.value())),
            Some(other) => Err(syn::Error::new_spanned(other, format!("`{name}` is a string"))),
            None => Ok(None),
        }
    }

    /// The flag that is none of `known`: the name of a reader of `Node`.
    pub(crate) fn reader(&self, known: &[&str]) -> syn::Result<Option<&syn::Ident>> {
        let mut readers = self.0.iter().filter_map(|option| match option {
            Meta::Path(path) => path.get_ident().filter(|ident| !known.iter().any(|name| ident == name)),
            _ => None,
        });
        let reader = readers.next();
        match readers.next() {
            Some(second) => Err(syn::Error::new_spanned(second, "a key has one reader")),
            None => Ok(reader),
        }
    }

    /// The type in the parentheses of an option.
    pub(crate) fn ty(&self, name: &str) -> syn::Result<Option<Type>> {
        let list = self.0.iter().find_map(|option| match option {
            Meta::List(list) if list.path.is_ident(name) => Some(list),
            _ => None,
        });
        list.map(|list| list.parse_args()).transpose()
    }

    /// Refuses options with other names than these, of which `lists` have parentheses; flags are readers, or of a field.
    pub(crate) fn only(&self, names: &[&str], lists: &[&str]) -> syn::Result<()> {
        for option in &self.0 {
            let is_known = match option {
                Meta::NameValue(pair) => names.iter().any(|name| pair.path.is_ident(name)),
                Meta::Path(_) => lists.is_empty(),
                Meta::List(list) => lists.iter().any(|name| list.path.is_ident(name)),
            };
            if !is_known {
                return Err(syn::Error::new_spanned(
                    option,
                    format!("no such option: the options are {}", names.join(", ")),
                ));
            }
        }
        Ok(())
    }

    /// Attribute of the physical dimension for the schema; nothing if the key has none.
    pub(crate) fn dimension(&self) -> TokenStream {
        let value = match self.value("dimension") {
            None => return TokenStream::new(),
            Some(words @ Expr::Lit(_)) => quote!(#words),
            Some(Expr::Array(several)) => {
                let each = several.elems.iter();
                quote!([#(crate::Dimension::#each),*])
            }
            Some(one) => quote!(crate::Dimension::#one),
        };
        quote!(#[cfg_attr(feature = "schema", schemars(extend("x-dimension" = #value)))])
    }
}
