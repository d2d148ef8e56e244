//! Coverpoints, their bins, and crosses.

use std::collections::BTreeMap;

use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, CrossMemberKind as Member, ExprSyntaxKind as Syntax, ItemSyntaxKind, NameSyntax, TemplateSyntaxKind,
};

use super::phase::TestingPhase;
use crate::check::{
    state::{scope::ExprEnv, table::NameTable, template::TemplateArgument},
    template::{CheckerPhase, template},
};
use crate::{
    BinCondition, BinaryOp, CoverBin, CoverCross, CoverPoint, CoverpointId, CrossBin, EventPattern, UnaryOp,
    Value,
    noun::Noun,
    report::{coverage::overlap, types},
};

impl TestingPhase<'_, '_> {
    pub(in crate::check) fn coverage(&mut self) {
        self.templates_of(TemplateSyntaxKind::Cover, |c, template| {
            if let ItemSyntaxKind::Cover(cover) = template.kind {
                c.point_of(cover);
            }
        });
        for (item, span) in self.each_item() {
            if template(item).is_some() {
                continue;
            }
            if let ItemSyntaxKind::Cover(cover) = item {
                let resolved = self.point_of(cover);
                self.add_point(&cover.name, cover, resolved, span);
            } else if let ItemSyntaxKind::Instance(instance) = item
                && instance.sort == TemplateSyntaxKind::Cover
                && let Some((template, given)) = self.instance(instance, &ExprEnv::constants())
                && let ItemSyntaxKind::Cover(cover) = template.kind
            {
                let place = Some((&instance.name, instance.span));
                let resolved = self.as_instance(Some(given), place, |c| c.point_of(cover));
                self.add_point(&instance.name, cover, resolved, span);
            }
        }
        self.templates_of(TemplateSyntaxKind::Cross, |c, template| {
            if let ItemSyntaxKind::Cross(cross) = template.kind {
                c.cross_of(cross, cross.name.span);
            }
        });
        for (item, span) in self.each_item() {
            if template(item).is_some() {
                continue;
            }
            if let ItemSyntaxKind::Cross(cross) = item {
                let resolved = self.cross_of(cross, span);
                self.cross(&cross.name, resolved);
            } else if let ItemSyntaxKind::Instance(instance) = item
                && instance.sort == TemplateSyntaxKind::Cross
                && let Some((template, given)) = self.instance(instance, &ExprEnv::constants())
                && let ItemSyntaxKind::Cross(cross) = template.kind
            {
                let place = Some((&instance.name, instance.span));
                let resolved = self.as_instance(Some(given), place, |c| c.cross_of(cross, span));
                self.cross(&instance.name, resolved);
            }
        }
    }

    fn add_point(
        &mut self,
        name: &NameSyntax,
        syntax: &ast::CoverSyntax,
        (count, bins): (Vec<EventPattern>, Vec<CoverBin>),
        span: Span,
    ) {
        self.not_a_template(TemplateSyntaxKind::Cover, name);
        let checker = self.checker();
        if checker.issues.declare(&mut checker.points, Noun::Point, name).is_some() {
            self.s.places.bins.push(syntax.bins.iter().map(|bin| bin.name.span).collect());
            self.s.points.push(CoverPoint { name: name.text.clone(), count, bins, origin: span });
        }
    }

    fn cross(&mut self, name: &NameSyntax, cross: CoverCross) {
        self.not_a_template(TemplateSyntaxKind::Cross, name);
        if self.checker.issues.declare(&mut self.crosses, Noun::Cross, name).is_some() {
            self.s.crosses.push(CoverCross { name: name.text.clone(), ..cross });
        }
    }

    fn point_of(&mut self, cover: &ast::CoverSyntax) -> (Vec<EventPattern>, Vec<CoverBin>) {
        let count = self.patterns(&cover.count);
        let mut table = NameTable::default();
        let (mut bins, mut covered) = (Vec::new(), CoveredBins::default());
        for bin in &cover.bins {
            self.issues.declare(&mut table, Noun::Bin, &bin.name);
            let resolved =
                self.bin(bin).unwrap_or(CoverBin { name: bin.name.text.clone(), lo: -1, hi: Some(-1) });
            if resolved.lo >= 0 {
                let (lo, hi) = (resolved.lo, resolved.hi.unwrap_or(i64::MAX));
                if let Some(other) = covered.add(lo, hi, bins.len()) {
                    let (other, first): (&CoverBin, Span) = (&bins[other], cover.bins[other].span);
                    let issue = overlap(&bin.name.text, bin.span, &other.name, first);
                    self.report(issue);
                }
            }
            bins.push(resolved);
        }
        (count, bins)
    }

    fn bin(&mut self, bin: &ast::BinSyntax) -> Option<CoverBin> {
        let lo = self.count(&bin.lo, "a bin's number", 0)?;
        let hi = match &bin.hi {
            Some(hi) => Some(self.count(hi, "a bin's number", 0)?),
            None => (!bin.open).then_some(lo),
        };
        if let Some(hi) = hi.filter(|hi| *hi < lo) {
            self.report(types::empty_range(Value::Int(lo), Value::Int(hi), bin.span));
            return None;
        }
        Some(CoverBin { name: bin.name.text.clone(), lo, hi })
    }

    fn cross_of(&mut self, cross: &ast::CrossSyntax, span: Span) -> CoverCross {
        let mut points = Vec::new();
        for name in &cross.points {
            points.extend(self.point_named(name));
        }
        let whole = points.len() == cross.points.len();
        let mut titles = NameTable::default();
        let (mut bins, mut ignore) = (Vec::new(), Vec::new());
        for member in &cross.members {
            match &member.kind {
                Member::Bin { name, when } => {
                    self.issues.declare_as(&mut titles, Noun::Bin, &name.text, name.span);
                    let when = self.cross_condition(when, &points, whole);
                    let name = name.text.clone();
                    bins.extend(when.map(|when| CrossBin { name, when, origin: member.span }));
                }
                Member::Ignore { when } => ignore.extend(self.cross_condition(when, &points, whole)),
                Member::Allow(_) | Member::Error => {}
            }
        }
        CoverCross { name: cross.name.text.clone(), points, bins, ignore, origin: span }
    }

    /// A formula over `point.bin`.
    fn cross_condition(
        &mut self,
        e: &ast::ExprSyntax,
        points: &[CoverpointId],
        whole: bool,
    ) -> Option<BinCondition> {
        if let Syntax::Binary { op: op @ (BinaryOp::And | BinaryOp::Or), left, right } = &e.kind {
            let (l, r) =
                (self.cross_condition(left, points, whole), self.cross_condition(right, points, whole));
            let both = vec![l?, r?];
            return Some(if *op == BinaryOp::And { BinCondition::And(both) } else { BinCondition::Or(both) });
        }
        if let Syntax::Unary { op: UnaryOp::Not, operand } = &e.kind {
            return Some(BinCondition::Not(Box::new(self.cross_condition(operand, points, whole)?)));
        }
        if let Syntax::Path(path) = &e.kind
            && let [point, bin] = path.names.as_slice()
        {
            return self.in_bin(point, bin, points, whole);
        }
        if e.kind != Syntax::Error {
            self.report(types::no_value("this", e.span).help("name a bin of a point: `legs.four`"));
        }
        None
    }

    fn in_bin(
        &mut self,
        point: &NameSyntax,
        bin: &NameSyntax,
        points: &[CoverpointId],
        whole: bool,
    ) -> Option<BinCondition> {
        match self.given(&point.text) {
            Some(TemplateArgument::Unknown) => {
                self.refer_given(point);
                return None;
            }
            Some(TemplateArgument::Point(id)) if points.contains(id) => {
                let id = *id;
                self.refer_given(point);
                return self.bin_of(id, bin);
            }
            Some(
                TemplateArgument::Point(_)
                | TemplateArgument::Value(_)
                | TemplateArgument::Events(_)
                | TemplateArgument::Actor(_)
                | TemplateArgument::Thing(..),
            )
            | None => {}
        }
        let name_of = |c: &Self, p: &CoverpointId| c.s.points[usize::from(p.0)].name.clone();
        let here = self.points.get(&point.text).map(CoverpointId).filter(|id| points.contains(id));
        let Some(id) = here else {
            // A point whose name is wrong may be the one that is meant.
            if !whole {
                return None;
            }
            let own = points.iter().map(|p| name_of(self, p));
            let all: Vec<String> = own.chain(self.given_names(Noun::Point)).collect();
            self.unknown(Noun::Point, point, &all, None);
            return None;
        };
        self.refer(point, self.points.span(id.0));
        self.bin_of(id, bin)
    }

    fn bin_of(&mut self, id: CoverpointId, bin: &NameSyntax) -> Option<BinCondition> {
        let of_point = &self.s.points[usize::from(id.0)].bins;
        let Some(at) = of_point.iter().position(|b| b.name == bin.text) else {
            let bins: Vec<String> = of_point.iter().map(|b| b.name.clone()).collect();
            self.unknown(Noun::Bin, bin, &bins, Some(Noun::Bin));
            return None;
        };
        let place = self.s.places.bins.get(usize::from(id.0)).and_then(|bins| bins.get(at)).copied();
        self.refer(bin, place);
        Some(BinCondition::In { point: id, bin: u16::try_from(at).unwrap_or(u16::MAX) })
    }
}

/// Which bin has each number: of those that share it the first. Wider numbers than those of bins have room for the end.
#[derive(Default)]
struct CoveredBins {
    /// By its first number: the last one, and the bin. They do not meet.
    pieces: BTreeMap<i128, (i128, usize)>,
    /// The same, neighbours joined.
    whole: BTreeMap<i128, i128>,
}

impl CoveredBins {
    /// Adds a bin; gives one that it meets.
    fn add(&mut self, lo: i64, hi: i64, bin: usize) -> Option<usize> {
        let (lo, hi) = (i128::from(lo), i128::from(hi));
        let before = self.pieces.range(..lo).next_back().filter(|(_, (end, _))| *end >= lo);
        let met = before.or_else(|| self.pieces.range(lo..=hi).next()).map(|(_, (_, bin))| *bin);
        let touches = self.whole.range(..lo).next_back().filter(|(_, end)| **end >= lo - 1);
        let first = touches.map_or(lo, |(start, _)| *start);
        let joined: Vec<(i128, i128)> = self.whole.range(first..=hi + 1).map(|(a, b)| (*a, *b)).collect();
        let (mut next, mut last) = (lo, hi);
        for (start, end) in joined {
            if next < start && next <= hi {
                self.pieces.insert(next, (hi.min(start - 1), bin));
            }
            (next, last) = (next.max(end + 1), last.max(end));
            self.whole.remove(&start);
        }
        if next <= hi {
            self.pieces.insert(next, (hi, bin));
        }
        self.whole.insert(first, last);
        met
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bin_meets_another_if_they_share_a_number() {
        let mut dice = 7u64;
        for _ in 0..300 {
            let (mut covered, mut all) = (CoveredBins::default(), Vec::new());
            for bin in 0..12 {
                dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let lo = (dice >> 33) as i64 % 40;
                let hi = if dice.is_multiple_of(7) { i64::MAX } else { lo + (dice >> 20) as i64 % 5 };
                let meets = |(l, h): &(i64, i64)| *l <= hi && lo <= *h;
                match covered.add(lo, hi, bin) {
                    Some(met) => assert!(meets(&all[met]), "{lo}..{hi} and {:?} of {all:?}", all[met]),
                    None => assert!(!all.iter().any(meets), "{lo}..{hi} and {all:?}"),
                }
                all.push((lo, hi));
            }
        }
    }
}
