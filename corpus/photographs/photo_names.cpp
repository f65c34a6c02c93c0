#include "corpus/photographs/stated_frames.h"

#include <algorithm>
#include <set>

namespace tessera::corpus {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> steps_of(const std::string& name) {
    std::vector<std::string> steps;
    for (const fs::path& step : lexical_path(name).lexically_normal().relative_path())
        if (!step.empty())
            steps.push_back(step == ".." ? "_" : step.string()); // stays in the folder of outputs
    if (steps.empty())
        steps.push_back("_");
    return steps;
}

std::string without_suffix(const std::string& file) {
    const fs::path path = lexical_path(file);
    std::string suffix = path.extension().string();
    std::ranges::transform(suffix, suffix.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return is_picture_suffix(suffix) ? path.stem().string() : file;
}

std::string joined_steps(const std::vector<std::string>& steps, std::size_t first,
                         const std::string& file) {
    std::string name;
    for (std::size_t i = first; i + 1 < steps.size(); ++i)
        name += steps[i] + "/";
    return name + file;
}

} // namespace

std::vector<std::string> names_of(std::span<const PosedPhotograph> photographs) {
    std::vector<std::vector<std::string>> paths;
    for (const PosedPhotograph& photograph : photographs)
        paths.push_back(steps_of(photograph.name));
    std::size_t shared = paths.empty() ? 0 : paths.front().size() - 1;
    for (const auto& steps : paths) {
        const auto end = std::ranges::mismatch(steps, paths.front()).in1;
        shared =
            std::min({shared, static_cast<std::size_t>(end - steps.begin()), steps.size() - 1});
    }
    for (const bool short_names : {true, false}) {
        std::vector<std::string> names;
        std::set<std::string> known;
        for (const auto& steps : paths) {
            names.push_back(joined_steps(
                steps, shared, short_names ? without_suffix(steps.back()) : steps.back()));
            known.insert(names.back());
        }
        if (known.size() == names.size())
            return names;
    }
    std::vector<std::string> numbers;
    for (std::size_t i = 0; i < paths.size(); ++i)
        numbers.push_back(std::to_string(i));
    return numbers;
}

} // namespace tessera::corpus
