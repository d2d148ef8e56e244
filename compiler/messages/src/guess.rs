//! Which interface was probably meant by a name that none has.

use std::collections::BTreeMap;

use hrdsl_source::nearest;

use crate::{
    known::KnownMessage,
    name::{InterfaceName, InterfaceSpace, RosVersion},
    primitive::PrimitiveType,
};

/// The interface that was probably meant: one of the same name in another package, one of a similar name in the same package, or
/// the same name in a package of a similar one.
pub(crate) fn nearest_interface<'a>(
    wanted: &InterfaceName,
    known: impl Iterator<Item = &'a InterfaceName>,
) -> Option<&'a InterfaceName> {
    let known: Vec<&InterfaceName> = known.collect();
    let of_that_name = || known.iter().filter(|name| name.name.eq_ignore_ascii_case(&wanted.name));
    let packages = of_that_name().map(|name| name.package.as_str());
    let in_near_package = nearest(&wanted.package, packages);
    if let Some(package) = in_near_package {
        return of_that_name().find(|name| name.package == package).copied();
    }
    let in_package = || known.iter().filter(|name| name.package == wanted.package);
    if let Some(near) = nearest(&wanted.name, in_package().map(|name| name.name.as_str())) {
        return in_package().find(|name| name.name == near).copied();
    }
    of_that_name().next().copied()
}

/// What a field was probably meant to hold, as it is to be written there.
pub(crate) fn nearest_type(
    wanted: &InterfaceName,
    home: &str,
    version: RosVersion,
    messages: &BTreeMap<InterfaceName, KnownMessage>,
) -> Option<String> {
    let known = || messages.keys().filter(|name| name.space == InterfaceSpace::Msg);
    let elsewhere = known().find(|name| name.name == wanted.name);
    if let (true, Some(name)) = (wanted.package == home, elsewhere) {
        return Some(name.in_field(version));
    }
    let words = PrimitiveType::ALL.into_iter().filter(|t| t.is_in(version)).map(PrimitiveType::word);
    let word = if wanted.package == home { nearest(&wanted.name, words) } else { None };
    word.map(str::to_owned).or_else(|| nearest_interface(wanted, known()).map(|name| name.in_field(version)))
}
