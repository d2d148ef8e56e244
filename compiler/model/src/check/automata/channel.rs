//! Channels: their declarations, and what an edge does over one.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{CallSyntax, NameSyntax};

use crate::check::{
    automata::{automaton::EdgeScope, phase::AutomataPhase},
    checker::EVENTS,
    state::{record::DeclaredFields, scope::ExprEnv},
    template::CheckerPhase,
};
use crate::{ChannelId, ChannelKind, EventId, TypedExpr, TypedSync, noun::Noun, report::automata};

/// What an edge takes or gives.
pub(in crate::check) enum EdgeMedium {
    Event(EventId),
    Channel(ChannelId),
}

impl AutomataPhase<'_, '_> {
    /// What `on` or `do` of an edge names.
    pub(in crate::check) fn medium(
        &mut self,
        scope: &EdgeScope,
        name: &NameSyntax,
        local: Option<Noun>,
    ) -> Option<EdgeMedium> {
        let given = self.given(&name.text).is_some();
        if let Some(id) = self.channels.table.get(&name.text).filter(|_| !given) {
            self.refer(name, self.channels.table.span(id));
            return Some(EdgeMedium::Channel(ChannelId(id)));
        }
        let known = given || self.events.table.get(&name.text).is_some();
        if !known && (scope.actor.is_none() || self.channels.table.names().next().is_some()) {
            let mut names = self.near_of(&[Noun::Channel]);
            if scope.actor.is_some() {
                names.extend(self.near_of(&EVENTS));
                names.extend(self.given_names(Noun::Event));
            }
            let noun = if scope.actor.is_some() { Noun::Medium } else { Noun::Channel };
            self.unknown(noun, name, &names, local);
            return None;
        }
        let event = self.event(Noun::EventOrStimulus, name, local)?;
        if scope.actor.is_none() {
            let noun = self.noun_of(event);
            let automaton = &self.s.automata[scope.index].name;
            self.report(automata::no_actor(automaton, noun, &name.text, name.span));
            return None;
        }
        Some(EdgeMedium::Event(event))
    }

    /// `on c(…)`
    pub(in crate::check) fn accept(
        &mut self,
        scope: &EdgeScope,
        channel: ChannelId,
        call: &CallSyntax,
        env: &mut ExprEnv,
        equal: &mut Vec<TypedExpr>,
    ) -> Option<TypedSync> {
        let fields = self.fields_of_channel(channel);
        if !self.is_joint(channel) {
            let args = self.received_args(Noun::Channel, call, &fields, env, equal)?;
            return Some(TypedSync::Accept { channel, args });
        }
        if call.args.as_ref().is_some_and(|args| !args.is_empty()) {
            self.wrong_arity(Noun::Channel, call, &fields);
        }
        // A template is no participant, but its instances may be.
        let vague = self.templates.by_itself || self.channels.vague.contains(&call.name.text);
        let of = &self.s.channels[usize::from(channel.0)];
        let participant = match &of.kind {
            ChannelKind::MultiWay(participants) => {
                participants.iter().any(|p| usize::from(p.automaton.0) == scope.index)
            }
            ChannelKind::Binary | ChannelKind::Broadcast => true,
        };
        if !participant && !vague {
            let place = self.s.places.channels[usize::from(channel.0)].name;
            let automaton = &self.s.automata[scope.index].name;
            self.report(automata::not_a_participant(automaton, &of.name, call.name.span, place));
        }
        Some(TypedSync::Join { channel })
    }

    /// `do c(…)`
    pub(in crate::check) fn offer(
        &mut self,
        channel: ChannelId,
        call: &CallSyntax,
        env: &mut ExprEnv,
    ) -> Option<TypedSync> {
        if self.is_joint(channel) {
            self.report(automata::multi_way_offered(&call.name.text, call.span));
            return None;
        }
        let fields = self.fields_of_channel(channel);
        let args = self.args(Noun::Channel, call, &fields, env);
        let params = self.s.channels[usize::from(channel.0)].params.len();
        (args.len() == params).then_some(TypedSync::Offer { channel, args })
    }

    /// The edges of an urgent channel have no clock guards, but those that accept a broadcast.
    pub(in crate::check) fn check_urgent(&mut self, sync: &TypedSync, clock_guard: Option<Span>) {
        let Some((channel, span)) = sync.channel().zip(clock_guard) else { return };
        let place = self.s.places.channels[usize::from(channel.0)].name;
        let channel = &self.s.channels[usize::from(channel.0)];
        let hears = matches!(sync, TypedSync::Accept { .. }) && channel.kind == ChannelKind::Broadcast;
        if channel.urgent && !hears {
            self.report(automata::urgent_guard(&channel.name, span, place));
        }
    }

    fn is_joint(&self, channel: ChannelId) -> bool {
        matches!(self.s.channels[usize::from(channel.0)].kind, ChannelKind::MultiWay(_))
    }

    fn fields_of_channel(&self, channel: ChannelId) -> DeclaredFields {
        self.channels.fields[usize::from(channel.0)].clone()
    }
}
