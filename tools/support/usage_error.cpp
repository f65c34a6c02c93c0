#include "tools/support/usage_error.h"

#include "tools/support/parse.h"
#include "tools/support/suggestions.h"

#include <algorithm>

namespace tessera {
namespace {

bool is_number(const std::string& word) {
    double value = 0;
    return parse_number(word, value);
}

std::vector<std::string> option_names(const CLI::App& verb) {
    std::vector<std::string> names;
    for (const CLI::Option* option : verb.get_options())
        for (const std::string& name : option->get_lnames())
            names.push_back("--" + name);
    return names;
}

bool has_option(const CLI::App& verb, const std::string& name) {
    return std::ranges::count(option_names(verb), name) > 0;
}

// "; it belongs to bake and encode", or "" if no verb has the option.
std::string where_it_belongs(const CLI::App& app, const std::string& option) {
    std::vector<std::string> verbs;
    for (const CLI::App* verb : app.get_subcommands({}))
        if (has_option(*verb, option))
            verbs.push_back(verb->get_name());
    std::string text;
    for (std::size_t i = 0; i < verbs.size(); ++i)
        text += (i == 0 ? "" : i + 1 == verbs.size() ? " and " : ", ") + verbs[i];
    return verbs.empty() ? "" : "; it belongs to " + text;
}

std::string unknown_option(const CLI::App& app, const CLI::App& verb, const std::string& word) {
    const std::string name = word.substr(0, word.find('='));
    std::string hint = did_you_mean(name, option_names(verb));
    if (hint.empty())
        hint = where_it_belongs(app, name);
    return "unknown option " + name + hint;
}

} // namespace

Status check_words(const CLI::App& verb, const std::vector<std::string>& words) {
    if (!has_option(verb, "--quality"))
        return {};
    for (std::size_t i = 0; i < words.size(); ++i) {
        const bool joined = words[i].starts_with("-q") && is_number(words[i].substr(2));
        if (!joined && (words[i] != "-q" || i + 1 == words.size() || !is_number(words[i + 1])))
            continue;
        const std::string number = joined ? words[i].substr(2) : words[i + 1];
        return {ErrorCode::bad_argument, "-q is --quiet and takes no number; did you mean "
                                         "--quality " +
                                             number + "?"};
    }
    return {};
}

Status usage_error(const CLI::App& app, const CLI::App* verb, const CLI::ParseError& error) {
    const std::string help =
        verb == nullptr ? "tessera --help" : "tessera " + verb->get_name() + " --help";
    std::string reason = error.what();
    const CLI::App& about = verb == nullptr ? app : *verb;
    const std::vector<std::string> unknown = about.remaining();
    const auto option = std::ranges::find_if(
        unknown, [](const std::string& word) { return word.size() > 1 && word[0] == '-'; });
    if (option != unknown.end())
        reason = unknown_option(app, about, *option);
    else if (!unknown.empty() && dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr)
        reason = "'" + unknown.front() + "' is one argument too many";
    std::ranges::replace(reason, '\n', ' ');
    return {ErrorCode::bad_argument, reason + " (see " + help + ")"};
}

} // namespace tessera
