//! Channels: their declarations.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ItemSyntaxKind};

use crate::check::{
    state::{names::ChannelNames, record::DeclaredFields, table::NameTable},
    template::CheckerPhase,
    vocabulary::phase::VocabularyPhase,
};
use crate::resolution::type_span;
use crate::{
    Channel, ChannelKind, ChannelParticipant, ChannelPlaces, EventId, PlayerRef,
    noun::Noun,
    report::{automata, names::duplicate},
    types::finite_var,
};

impl VocabularyPhase<'_, '_> {
    /// After the automata have their names: those are the participants of multi-way channels.
    pub(super) fn channels(&mut self) -> ChannelNames {
        let mut channels = ChannelNames::default();
        for (item, span) in self.each_item() {
            if let ItemSyntaxKind::Channel(channel) = item {
                self.declare_channel(channel, span, &mut channels);
            }
        }
        channels
    }

    fn declare_channel(&mut self, channel: &ast::ChannelSyntax, whole: Span, channels: &mut ChannelNames) {
        for one in &channel.names {
            let name = &one.name;
            let fields = self.channel_params(&one.params);
            let mut participants = Vec::new();
            let kind = match &channel.kind {
                ast::ChannelSyntaxKind::Binary => ChannelKind::Binary,
                ast::ChannelSyntaxKind::Broadcast => ChannelKind::Broadcast,
                ast::ChannelSyntaxKind::MultiWay(of) => {
                    if let Some(param) = one.params.first() {
                        self.report(automata::multi_way_params(&name.text, param.name.span));
                    }
                    let (of, vague) = self.participants(of, &mut participants);
                    channels.vague.extend(vague.then(|| name.text.clone()));
                    ChannelKind::MultiWay(of)
                }
            };
            if let Some(event) = self.events.table.get(&name.text) {
                let noun = self.noun_of(EventId(event));
                self.report(duplicate(noun, &name.text, name.span, self.events.table.span(event)));
                continue;
            }
            if self.issues.declare(&mut channels.table, Noun::Channel, name).is_none() {
                continue;
            }
            let params = self.flat(&fields).iter().map(|p| finite_var(&p.name, p.ty)).collect();
            channels.fields.push(fields);
            let span = if channel.names.len() == 1 { whole } else { name.span };
            let (text, urgent) = (name.text.clone(), channel.urgent);
            self.s.channels.push(Channel { name: text, kind, urgent, params, origin: span });
            self.s.places.channels.push(ChannelPlaces { name: name.span, participants });
        }
    }

    /// Parameters of finite types.
    fn channel_params(&mut self, params: &[ast::ParamSyntax]) -> DeclaredFields {
        let fields = self.fields(params);
        for (param, (_, layout)) in params.iter().zip(fields.iter()) {
            if self.plain(layout, &param.name.text, type_span(&param.ty)) {
                self.finite_layout(layout, "a parameter of a channel", param.name.span);
            }
        }
        fields
    }

    /// The automata of a multi-way channel, and whether one has a diagnostic; `places` gets where they are named.
    fn participants(
        &mut self,
        participants: &[ast::ParticipantSyntax],
        places: &mut Vec<Span>,
    ) -> (Vec<ChannelParticipant>, bool) {
        let (mut resolved, mut seen, mut vague) = (Vec::new(), NameTable::default(), false);
        for participant in participants {
            let name = &participant.automaton;
            let player = self.players.table.get(&name.text).map(|id| self.players.ids[usize::from(id)]);
            let Some(PlayerRef::Automaton(automaton)) = player else {
                let all = self.near_of(&[Noun::Automaton]);
                self.unknown(Noun::Automaton, name, &all, None);
                vague = true;
                continue;
            };
            self.refer(name, self.players.table.span_of(&name.text));
            if self.issues.declare(&mut seen, Noun::Automaton, name).is_some() {
                resolved.push(ChannelParticipant { automaton, optional: participant.optional });
                places.push(name.span);
            }
        }
        (resolved, vague)
    }
}
