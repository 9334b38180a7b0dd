// Typed options on top of the one kind that the command-line parser knows here: a word.
#include <support/tool.h>
#include <support/words.h>

#include <limits>

namespace haarlight::tool {

void Tool::value(int& number, const std::string& names, const std::string& help, int low,
                 int high) {
  add_option(names, "INT", std::to_string(number), help, [&number, low, high](const auto& word) {
    number = static_cast<int>(integer_of(word, low, high));
  });
}

void Tool::value(std::uint64_t& number, const std::string& names, const std::string& help) {
  add_option(names, "INT", std::to_string(number), help,
             [&number](const auto& word) { number = natural_of(word); });
}

void Tool::value(double& number, const std::string& names, const std::string& help, double low,
                 double high) {
  add_option(names, "NUM", short_text(number), help,
             [&number, low, high](const auto& word) { number = number_of(word, low, high); });
}

void Tool::value(float& number, const std::string& names, const std::string& help, double low,
                 double high) {
  add_option(names, "NUM", short_text(static_cast<double>(number)), help,
             [&number, low, high](const auto& word) {
               number = static_cast<float>(number_of(word, low, high));
             });
}

void Tool::value(std::optional<int>& number, const std::string& names, const std::string& help,
                 int low, int high) {
  add_option(names, "INT", number ? std::to_string(*number) : "", help,
             [&number, low, high](const auto& word) {
               number = static_cast<int>(integer_of(word, low, high));
             });
}

void Tool::value(std::optional<double>& number, const std::string& names, const std::string& help,
                 double low, double high) {
  add_option(names, "NUM", number ? short_text(*number) : "", help,
             [&number, low, high](const auto& word) { number = number_of(word, low, high); });
}

void Tool::values(std::vector<double>& numbers, const std::string& names, const std::string& help,
                  std::size_t count, double low, double high) {
  std::string shown;
  for (const double number : numbers)
    shown.append(shown.empty() ? "" : ",").append(short_text(number));
  std::string placeholder = "NUM";
  for (std::size_t i = 1; i < count; ++i)
    placeholder += ",NUM";
  add_option(names, placeholder, shown, help, [&numbers, count, low, high](const auto& word) {
    numbers = numbers_of(word, count, low, high);
  });
}

void Tool::text(std::string& text, const std::string& names, const std::string& placeholder,
                const std::string& help) {
  add_option(names, placeholder, text, help, [&text](const auto& word) { text = word; });
}

} // namespace haarlight::tool
