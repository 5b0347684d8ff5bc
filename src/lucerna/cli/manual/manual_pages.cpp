// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/manual/manual_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

#include "lucerna/cli/manual/program_options.h"
#include "lucerna/version.h"

namespace lucerna::cli {

namespace {

/// A command line and what it does.
struct ManualExample {
  std::string_view command, line, meaning;
};

constexpr std::array kExamples{
    ManualExample{"init", "lucerna init -o lamp.toml", "Writes a project to start from."},
    ManualExample{"info", "lucerna info led.tm25ray", "Says what is in a ray file."},
    ManualExample{"check", "lucerna check --strict files", "Names every fault of the files in a folder."},
    ManualExample{"convert", "lucerna convert led.dat led.tm25ray --rays 1e6",
                  "Keeps a million rays, in another format."},
    ManualExample{"make-source", "lucerna make-source led -n 1e6 -o led.tm25ray",
                  "Writes the rays of an LED of four dies."},
    ManualExample{"compress", "lucerna compress led.tm25ray -o led.nfl", "Makes a model of a ray file."},
    ManualExample{"sample", "lucerna sample led.nfl -n 1e6 -o sampled.tm25ray",
                  "Draws a million rays from a model."},
    ManualExample{"trace", "lucerna trace lamp.toml -o result --report result.html",
                  "Traces until the light distribution is known to 1 % of its peak."},
    ManualExample{"merge", "lucerna merge part1 part2 -o whole", "Adds two traces of ranges of rays."},
    ManualExample{"compare", "lucerna compare led.tm25ray led.nfl", "Says how far a model is from its rays."},
    ManualExample{"design", "lucerna design lamp.toml -o mirror --time 60", "Designs for a minute at most."},
    ManualExample{"report", "lucerna report mirror -o mirror.html", "Writes the report of a design."},
    ManualExample{"bench", "lucerna bench --device cpu", "Measures the processor."},
};

/// Text as man(7) takes it: hyphens that can be copied, no line that begins with a macro.
std::string manual_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool begins = out.empty() || out.back() == '\n';
    if (begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else if (c == '\'') {
      out += "\\(aq";
    } else {
      out += c;
    }
  }
  return out;
}

/// With a full stop at its end.
std::string manual_sentence(const std::string& text) {
  return manual_text(text) + (text.ends_with('.') ? "" : ".");
}

/// What represents an option's value: RAYS for --rays.
std::string value_name(const OptionFacts& option) {
  std::string name = option.names.back();
  name.erase(0, name.find_first_not_of('-'));
  for (char& c : name) c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return manual_text(name);
}

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  return fmt::format("{}", fmt::join(words, between));
}

/// "\fB\-o\fR, \fB\-\-output\fR \fIOUTPUT\fR"
std::string option_heading(const OptionFacts& option) {
  std::string text;
  for (const std::string& name : option.names)
    text += fmt::format("{}\\fB{}\\fR", text.empty() ? "" : ", ", manual_text(name));
  if (option.flag) return text;
  return fmt::format("{} \\fI{}\\fR{}", text, value_name(option), option.several ? " ..." : "");
}

std::string option_entry(const OptionFacts& option) {
  const std::string& name = option.names.front();
  const std::string heading =
      option.positional ? fmt::format("\\fI{}\\fR{}", manual_text(name), option.several ? " ..." : "")
                        : option_heading(option);
  std::string text = fmt::format(".TP\n{}\n{}\n", heading, manual_sentence(option.help));
  if (!option.choices.empty()) text += fmt::format("One of {}.\n", manual_text(joined(option.choices, ", ")));
  if (!option.range.empty()) text += fmt::format("A whole number, {}.\n", manual_text(option.range));
  if (option.required && !option.positional) text += "Must be given.\n";
  if (!option.default_value.empty())
    text += fmt::format("The default is {}.\n", manual_text(option.default_value));
  return text;
}

std::string section_of(const CommandFacts& command, bool positional, const char* title) {
  std::string text;
  for (const OptionFacts& option : command.options) {
    if (option.positional == positional) text += option_entry(option);
  }
  return text.empty() ? "" : fmt::format(".SH {}\n", title) + text;
}

std::string synopsis(const CommandFacts& command) {
  std::string text = fmt::format(".SH SYNOPSIS\n\\fBlucerna {}\\fR [\\fIoptions\\fR]", command.name);
  for (const OptionFacts& option : command.options) {
    if (option.positional) {
      text += fmt::format(" \\fI{}\\fR{}", manual_text(option.names.front()), option.several ? " ..." : "");
    } else if (option.required) {
      text += fmt::format(" \\fB{}\\fR \\fI{}\\fR", manual_text(option.names.front()), value_name(option));
    }
  }
  return text + "\n";
}

constexpr std::string_view kExitStatus = R"(.SH EXIT STATUS
.TP
.B 0
Done.
.TP
.B 1
Bad input, or a check that failed; one line on standard error names file, place, what was found and
what was expected.
.TP
.B 2
A command line that is not understood.
.TP
.B 3
Interrupted (Ctrl\-C); files that were written are whole.
)";

std::string examples_of(std::string_view command) {
  std::string text = ".SH EXAMPLES\n";
  for (const ManualExample& e : kExamples) {
    if (!command.empty() && e.command != command) continue;
    text += fmt::format(".TP\n\\fB{}\\fR\n{}\n", manual_text(e.line), manual_text(e.meaning));
  }
  return text;
}

std::string heading(const std::string& name, std::string help) {
  std::string title = name;
  for (char& c : title) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (help.size() > 1 && std::islower(static_cast<unsigned char>(help[1])))
    help[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(help[0])));
  return fmt::format(".TH {} 1 \"\" \"Lucerna {}\" \"Lucerna\"\n.SH NAME\n{} \\- {}\n", manual_text(title),
                     version(), manual_text(name), manual_text(help));
}

ManualPage command_page(const CommandFacts& command) {
  const std::string name = "lucerna-" + command.name;
  return {name + ".1", heading(name, command.help) + synopsis(command) + ".SH DESCRIPTION\n" +
                           manual_sentence(command.help) + "\n" + section_of(command, true, "ARGUMENTS") +
                           section_of(command, false, "OPTIONS") + std::string(kExitStatus) +
                           examples_of(command.name) + ".SH SEE ALSO\n.BR lucerna (1)\n"};
}

constexpr std::string_view kProgramHead = R"(.SH SYNOPSIS
\fBlucerna\fR \fIcommand\fR [\fIoptions\fR] ...
.SH DESCRIPTION
Lucerna makes small models of the ray files of light sources, traces light through mirrors, designs the
mirror that gives a wanted light distribution, and reads and writes the files of the trade: ray files
(TM\-25, Zemax, LightTools, SPEOS, ASAP, MCPL, text), light distributions (IES LM\-63, EULUMDAT), and mirrors
for CAD (STEP, STL, OBJ, DXF).
.PP
Each command has a page of its own, and says what it takes with \fB\-\-help\fR.
Results go to standard output, remarks to standard error; with \fB\-\-json\fR a result is one JSON object.
The same seed gives the same bits, whatever the number of threads.
.SH OPTIONS
.TP
\fB\-h\fR, \fB\-\-help\fR
Print the list of commands and exit.
.TP
\fB\-\-version\fR
Print the version and exit.
.SH COMMANDS
)";

ManualPage program_page(const std::vector<CommandFacts>& commands) {
  std::string text = heading("lucerna", "From ray file to reflector") + std::string(kProgramHead), also;
  for (const CommandFacts& c : commands) {
    text += fmt::format(".TP\n.BR lucerna\\-{} (1)\n{}\n", manual_text(c.name), manual_sentence(c.help));
    also += fmt::format("{}.BR lucerna\\-{} (1)", also.empty() ? "" : ",\n", manual_text(c.name));
  }
  return {"lucerna.1", text + std::string(kExitStatus) + examples_of("") + ".SH SEE ALSO\n" + also + "\n"};
}

}  // namespace

std::vector<ManualPage> manual_pages() {
  const std::vector<CommandFacts> commands = program_commands();
  std::vector<ManualPage> pages{program_page(commands)};
  for (const CommandFacts& command : commands) pages.push_back(command_page(command));
  return pages;
}

}  // namespace lucerna::cli
