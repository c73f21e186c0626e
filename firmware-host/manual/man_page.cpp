#include "firmware-host/manual/man_page.h"

#include <cctype>
#include <string_view>

namespace pelorus {
namespace {

constexpr std::string_view kExitCodes = "Exit codes: ";
constexpr std::string_view kOwnName = "Pelorus: ";

// Plain text as roff shows it: no macro at the start of a line, hyphens that can be copied into a shell.
std::string roff(std::string_view text) {
  std::string out;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) out += "\\&";
    line_start = c == '\n';
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return out;
}

std::string bold(std::string_view text) { return "\\fB" + roff(text) + "\\fR"; }

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::vector<const CLI::App*> verbs_of(const CLI::App& parser) {
  return parser.get_subcommands([](const CLI::App* verb) { return !verb->get_group().empty(); });
}

// "Usage: pelorus replay [OPTIONS] DATASET" of --help, without its first word.
std::string synopsis(const CLI::App& parser, const std::string& name) {
  std::string usage = CLI::Formatter().make_usage(&parser, name);
  usage.erase(0, usage.find(name) + name.size());
  while (!usage.empty() && usage.back() == '\n') usage.pop_back();
  return bold(name) + roff(usage) + "\n";
}

// Positionals first, then options: names as on the command line, what they take, what they mean.
std::string option_list(const CLI::App& parser) {
  const CLI::Formatter help;
  std::string out;
  for (const bool positional : {true, false}) {
    for (const CLI::Option* option : parser.get_options()) {
      if (option->get_group().empty() || option->get_positional() != positional) continue;
      out += ".TP\n" + bold(help.make_option_name(option, positional)) + roff(help.make_option_opts(option)) + "\n";
      out += roff(option->get_description()) + "\n";
    }
  }
  return out;
}

// The footer of --help: prose, then the exit codes.
struct Footer {
  std::string prose;
  std::string exit_codes;
};

Footer footer_of(const CLI::App& parser) {
  const std::string text = parser.get_footer();
  const std::size_t codes = text.find(kExitCodes);
  if (codes == std::string::npos) return {text, ""};
  return {text.substr(0, codes), text.substr(codes + kExitCodes.size())};
}

std::string head(const ManualFacts& facts, const std::string& page, const std::string& description) {
  return ".TH " + upper(page) + " " + facts.section + " \"\" \"pelorus " + roff(facts.version) +
         "\" \"Pelorus\"\n.SH NAME\n" + roff(page) + " \\- " + roff(description) + "\n";
}

enum class Verbs { inside, apart };  // whether the verbs of the parser are told on its own page

std::string usage_sections(const CLI::App& parser, const std::string& name, Verbs verbs) {
  std::string out = ".SH SYNOPSIS\n";
  const auto parts = verbs == Verbs::inside ? verbs_of(parser) : std::vector<const CLI::App*>();
  if (parts.empty()) out += synopsis(parser, name);
  for (const CLI::App* part : parts) {
    out += (part == parts.front() ? "" : ".br\n") + synopsis(*part, name + " " + part->get_name());
  }
  const Footer footer = footer_of(parser);
  if (!footer.prose.empty()) out += ".SH DESCRIPTION\n" + roff(footer.prose);
  if (out.back() != '\n') out += "\n";
  return out + ".SH OPTIONS\n" + option_list(parser);
}

std::string exit_section(const std::string& codes) {
  return codes.empty() ? "" : ".SH EXIT STATUS\n" + roff(codes) + (codes.back() == '\n' ? "" : "\n");
}

ManPage verb_page(const CLI::App& verb, const ManualFacts& facts) {
  const std::string name = facts.program + " " + verb.get_name();
  const std::string page = facts.program + "-" + verb.get_name();
  std::string text = head(facts, page, verb.get_description()) + usage_sections(verb, name, Verbs::inside);
  for (const CLI::App* part : verbs_of(verb)) {
    const Footer footer = footer_of(*part);
    text += ".SH \"" + upper(roff(verb.get_name() + " " + part->get_name())) + "\"\n" + roff(part->get_description()) +
            ".\n" + option_list(*part);
    if (!footer.prose.empty()) text += ".PP\n" + roff(footer.prose) + (footer.prose.back() == '\n' ? "" : "\n");
    if (!footer.exit_codes.empty()) text += ".PP\nExit status: " + roff(footer.exit_codes) + "\n";
  }
  text += exit_section(footer_of(verb).exit_codes);
  text += ".SH SEE ALSO\n" + bold(facts.program) + "(" + facts.section + "), " + facts.see_also + "\n";
  return {page + "." + facts.section, text};
}

}  // namespace

std::vector<ManPage> man_pages(const CLI::App& parser, const ManualFacts& facts) {
  std::vector<ManPage> pages;
  std::string description = parser.get_description();
  if (description.starts_with(kOwnName)) description.erase(0, kOwnName.size());
  if (description.ends_with('.')) description.pop_back();
  std::string text = head(facts, facts.program, description) + usage_sections(parser, facts.program, Verbs::apart);
  if (const auto verbs = verbs_of(parser); !verbs.empty()) {
    text += ".SH VERBS\n";
    for (const CLI::App* verb : verbs) {
      pages.push_back(verb_page(*verb, facts));
      text += ".TP\n" + bold(verb->get_name()) + "\n" + roff(verb->get_description()) + ": see " +
              bold(facts.program + "-" + verb->get_name()) + "(" + facts.section + ")\n";
    }
  }
  text += exit_section(footer_of(parser).exit_codes) + ".SH SEE ALSO\n" + facts.see_also + "\n";
  pages.insert(pages.begin(), {facts.program + "." + facts.section, text});
  return pages;
}

}  // namespace pelorus
