// The words of hrdsl, and the units of its numbers. Both need more than a regular expression: which words are keywords
// depends on the neighbours, and a number takes the unit after it only on the same line.
//
// No state is kept between two calls.

#include "tree_sitter/parser.h"

#include <string.h>

// In the order of `externals` in grammar.js.
enum Token {
  IDENTIFIER,
  MEMBER,
  ORIGIN,
  UNIT,
  QUANTIFIER,
  MISSING_BRACE,
#define HEAD(id, word) KEYWORD_##id,
#define HARD(id, word) KEYWORD_##id,
#define SOFT(id, word) KEYWORD_##id,
#include "keywords.h"
#undef HEAD
#undef HARD
#undef SOFT
  NEVER,
};

// What a keyword reserves: a head starts a declaration; only a soft one can be a name.
typedef enum { CLASS_HEAD, CLASS_HARD, CLASS_SOFT } Class;

typedef struct {
  const char *word;
  Class class;
  enum Token token;
} Keyword;

static const Keyword KEYWORDS[] = {
#define HEAD(id, word) {word, CLASS_HEAD, KEYWORD_##id},
#define HARD(id, word) {word, CLASS_HARD, KEYWORD_##id},
#define SOFT(id, word) {word, CLASS_SOFT, KEYWORD_##id},
#include "keywords.h"
#undef HEAD
#undef HARD
#undef SOFT
};

enum { KEYWORD_COUNT = sizeof(KEYWORDS) / sizeof(KEYWORDS[0]), LONGEST = 32 };

// A word, as far as its text matters: no keyword is longer.
typedef struct {
  char text[LONGEST];
  unsigned length;
} Word;

static bool is_digit(int32_t c) { return c >= '0' && c <= '9'; }

static bool is_letter(int32_t c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

static bool is_blank(int32_t c) { return c == ' ' || c == '\t' || c == '\r'; }

static void advance(TSLexer *lexer) { lexer->advance(lexer, false); }

static void take_blanks(TSLexer *lexer) {
  while (is_blank(lexer->lookahead)) advance(lexer);
}

static Word take_word(TSLexer *lexer) {
  Word word = {.length = 0};
  while (is_letter(lexer->lookahead) || is_digit(lexer->lookahead)) {
    if (word.length < LONGEST) word.text[word.length] = (char)lexer->lookahead;
    word.length++;
    advance(lexer);
  }
  return word;
}

static bool equals(const Word *word, const char *text) {
  return word->length < LONGEST && strlen(text) == word->length && memcmp(text, word->text, word->length) == 0;
}

static const Keyword *keyword_of(const Word *word) {
  for (unsigned i = 0; i < KEYWORD_COUNT; i++) {
    if (equals(word, KEYWORDS[i].word)) return &KEYWORDS[i];
  }
  return NULL;
}

// Neither a keyword nor `_`.
static bool is_plain(const Word *word) { return !equals(word, "_") && keyword_of(word) == NULL; }

// Is `->` next, perhaps after comments and on another line? Moves on; the token must have been marked.
static bool before_arrow(TSLexer *lexer) {
  for (;;) {
    while (is_blank(lexer->lookahead) || lexer->lookahead == '\n') advance(lexer);
    if (lexer->lookahead != '/') break;
    advance(lexer);
    if (lexer->lookahead != '/') return false;
    while (lexer->lookahead != '\n' && !lexer->eof(lexer)) advance(lexer);
  }
  if (lexer->lookahead != '-') return false;
  advance(lexer);
  return lexer->lookahead == '>';
}

// Whether a word begins a clause of a sensor: `late 50 ms`.
static bool starts_sensing(TSLexer *lexer, const Word *word) {
  static const char *const WORDS[] = {"every", "late", "noise", "drift", "dropout", "flip", "outlier"};
  for (unsigned i = 0; i < sizeof WORDS / sizeof *WORDS; i++) {
    if (!equals(word, WORDS[i])) continue;
    take_blanks(lexer);
    return is_digit(lexer->lookahead) || is_letter(lexer->lookahead);
  }
  return false;
}

// After `50 %`: an operand on the same line makes it a remainder.
static bool before_operand(TSLexer *lexer) {
  take_blanks(lexer);
  int32_t next = lexer->lookahead;
  if (is_digit(next) || next == '(' || next == '[' || next == '"' || next == '~') return true;
  if (!is_letter(lexer->lookahead)) return false;
  Word word = take_word(lexer);
  if (starts_sensing(lexer, &word)) return false;
  const Keyword *keyword = keyword_of(&word);
  return keyword == NULL || keyword->class == CLASS_SOFT || equals(&word, "true") || equals(&word, "false");
}

// What a word after a number is.
typedef enum { AFTER_NUMBER_UNIT, AFTER_NUMBER_NAME, AFTER_NUMBER_ORIGIN } AfterNumber;

// By what follows the word: in `seed 17 look(true)` it is a name.
static AfterNumber before_mark(TSLexer *lexer) {
  take_blanks(lexer);
  int32_t first = lexer->lookahead;
  if (first == '(' || first == ':') return AFTER_NUMBER_NAME;
  if (first != '.' && first != '=' && first != '+' && first != '-') return AFTER_NUMBER_UNIT;
  advance(lexer);
  int32_t second = lexer->lookahead;
  if (first == '-' && second == '>') return AFTER_NUMBER_ORIGIN;
  bool mark = first == '.' ? second != '.' : first == '=' ? second != '=' : second == '=';
  return mark ? AFTER_NUMBER_NAME : AFTER_NUMBER_UNIT;
}

// `^2`, without blanks.
static void take_power(TSLexer *lexer) {
  if (lexer->lookahead != '^') return;
  advance(lexer);
  if (!is_digit(lexer->lookahead)) return;
  while (is_digit(lexer->lookahead)) advance(lexer);
  lexer->mark_end(lexer);
}

static bool take_percent(TSLexer *lexer) {
  advance(lexer);
  lexer->mark_end(lexer);
  if (lexer->lookahead == '^') {
    take_power(lexer);
    return true;
  }
  return !before_operand(lexer);
}

// What the word is that stands after a number on its line, and if it is a unit the rest of it: `s`, `rad/s`, `m/s^2`.
static AfterNumber after_number(TSLexer *lexer) {
  if (lexer->lookahead == '/') {
    advance(lexer);
    if (is_letter(lexer->lookahead)) {
      Word per = take_word(lexer);
      if (is_plain(&per)) {
        lexer->mark_end(lexer);
        take_power(lexer);
      }
    }
    return AFTER_NUMBER_UNIT;
  }
  if (lexer->lookahead == '^') {
    take_power(lexer);
    return AFTER_NUMBER_UNIT;
  }
  return before_mark(lexer);
}

// Does the first word of a line begin a declaration or a plan that cannot stand in the block that is open? Then the
// brace that ends the block is missing. Moves on; the token must have been marked.
static bool in_wrong_block(TSLexer *lexer, const Keyword *keyword, const bool *valid) {
  if (keyword == NULL || valid[keyword->token]) return false;
  if (keyword->token != KEYWORD_plan && keyword->class != CLASS_HEAD) return false;
  take_blanks(lexer);
  int32_t next = lexer->lookahead;
  if (keyword->token == KEYWORD_plan) return next == '+' || next == '-' || next == '@';
  if (keyword->token == KEYWORD_world && next == '{') return true;
  return is_letter(next);
}

// `E<>`, `A[]` and the like, without blanks: the mark after the letter. Moves on; the word must have been marked.
static bool take_quantifier(TSLexer *lexer, const Word *word) {
  int32_t open = lexer->lookahead;
  if ((!equals(word, "E") && !equals(word, "A")) || (open != '<' && open != '[')) return false;
  advance(lexer);
  if (lexer->lookahead != (open == '<' ? '>' : ']')) return false;
  advance(lexer);
  lexer->mark_end(lexer);
  return true;
}

// Whether a word that may begin a requirement's pattern is an event: `at causes x`.
static bool is_event(TSLexer *lexer, const Word *word) {
  static const char *const WORDS[] = {"at", "exactly", "always", "eventually", "whenever"};
  static const char *const NEXT[] = {"causes", "forbids", "precedes", "or"};
  bool begins = false;
  for (unsigned i = 0; i < sizeof WORDS / sizeof *WORDS; i++) begins = begins || equals(word, WORDS[i]);
  if (!begins) return false;
  take_blanks(lexer);
  if (!is_letter(lexer->lookahead)) return false;
  Word next = take_word(lexer);
  for (unsigned i = 0; i < sizeof NEXT / sizeof *NEXT; i++) {
    if (equals(&next, NEXT[i])) return true;
  }
  return false;
}

// What a word is here. A word is always taken, also where none fits: its parts must not be read as keywords.
static enum Token role(TSLexer *lexer, const Word *word, bool same_line, bool failed, const bool *valid) {
  const Keyword *keyword = keyword_of(word);
  bool name = keyword == NULL || keyword->class == CLASS_SOFT;
  if (!failed && valid[MEMBER] && (name || same_line)) return MEMBER;
  if (name && valid[ORIGIN] && before_arrow(lexer)) return ORIGIN;
  if (keyword == NULL) return IDENTIFIER;
  if (!valid[IDENTIFIER]) return keyword->token;
  if (valid[keyword->token]) return !failed && is_event(lexer, word) ? IDENTIFIER : keyword->token;
  // No declaration begins within a line where a name is due: `body cover: …`.
  bool head_as_name = keyword->class == CLASS_HEAD && same_line;
  return name || head_as_name ? IDENTIFIER : keyword->token;
}

bool tree_sitter_hri_external_scanner_scan(void *payload, TSLexer *lexer, const bool *valid) {
  (void)payload;
  // Without text, unless marked again.
  lexer->mark_end(lexer);
  // All tokens are valid only while the parser looks for a place to go on after a fault.
  bool failed = valid[NEVER];
  bool same_line = true;
  while (is_blank(lexer->lookahead) || lexer->lookahead == '\n') {
    if (lexer->lookahead == '\n') same_line = false;
    lexer->advance(lexer, true);
  }
  bool unit = valid[UNIT] && !failed && same_line;
  if (lexer->lookahead == '%' && unit) {
    lexer->result_symbol = UNIT;
    return take_percent(lexer);
  }
  if (!is_letter(lexer->lookahead)) return false;
  Word word = take_word(lexer);
  if (equals(&word, "_")) return false;
  if (valid[MISSING_BRACE] && !failed && !same_line && in_wrong_block(lexer, keyword_of(&word), valid)) {
    lexer->result_symbol = MISSING_BRACE;
    return true;
  }
  lexer->mark_end(lexer);
  if (take_quantifier(lexer, &word)) {
    lexer->result_symbol = QUANTIFIER;
    return true;
  }
  if (unit && is_plain(&word)) {
    static const enum Token TOKENS[] = {UNIT, IDENTIFIER, ORIGIN};
    lexer->result_symbol = TOKENS[after_number(lexer)];
    return true;
  }
  lexer->result_symbol = role(lexer, &word, same_line, failed, valid);
  return true;
}

void *tree_sitter_hri_external_scanner_create(void) { return NULL; }

void tree_sitter_hri_external_scanner_destroy(void *payload) { (void)payload; }

unsigned tree_sitter_hri_external_scanner_serialize(void *payload, char *buffer) {
  (void)payload;
  (void)buffer;
  return 0;
}

void tree_sitter_hri_external_scanner_deserialize(void *payload, const char *buffer, unsigned length) {
  (void)payload;
  (void)buffer;
  (void)length;
}
