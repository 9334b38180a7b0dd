#include <view/window_panel.h>

#include <imgui.h>

#include <array>
#include <string>

namespace haarlight::view {
namespace {

void choose(const char* label, const std::vector<std::string>& names, int& chosen) {
  const auto name = [&](int i) { return names[static_cast<std::size_t>(i)].c_str(); };
  if (!ImGui::BeginCombo(label, name(chosen)))
    return;
  for (int i = 0; i < static_cast<int>(names.size()); ++i) {
    ImGui::PushID(i);
    if (ImGui::Selectable(name(i), i == chosen))
      chosen = i;
    ImGui::PopID();
  }
  ImGui::EndCombo();
}

void choose_coarseness(int& coarseness) {
  ImGui::TextUnformatted("pixels");
  const std::array<std::pair<const char*, int>, 3> choices = {{{"1:1", 1}, {"2:1", 2}, {"4:1", 4}}};
  for (const auto& [label, value] : choices) {
    ImGui::SameLine();
    ImGui::RadioButton(label, &coarseness, value);
  }
}

void set_light(const PanelContents& contents, Settings& settings) {
  choose("light", contents.lights, settings.light);
  ImGui::SliderFloat("light turn", &settings.light_turn, -180, 180, "%.0f deg");
  ImGui::SliderFloat("light tilt", &settings.light_tilt, -90, 90, "%.0f deg");
  if (settings.light > 0)
    ImGui::SliderFloat("doubt", &settings.tolerance, 1e-4F, 0.1F, "%.4f",
                       ImGuiSliderFlags_Logarithmic);
}

void tell_figures(const std::vector<SideFigures>& sides) {
  if (!ImGui::BeginTable("figures", 4, ImGuiTableFlags_BordersInnerH))
    return;
  ImGui::TableSetupColumn("file", ImGuiTableColumnFlags_WidthStretch);
  for (const char* name : {"reads/px", "ms", "MiB"})
    ImGui::TableSetupColumn(name, ImGuiTableColumnFlags_WidthFixed, 56);
  ImGui::TableHeadersRow();
  for (const SideFigures& side : sides) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(side.name.c_str());
    ImGui::TableNextColumn();
    ImGui::Text("%.1f", side.accesses);
    ImGui::TableNextColumn();
    ImGui::Text(side.milliseconds < 1000 ? "%.1f" : "%.0f", side.milliseconds);
    ImGui::TableNextColumn();
    ImGui::Text("%.1f", static_cast<double>(side.texture_bytes) / (1 << 20));
  }
  ImGui::EndTable();
}

void tell_news(const PanelContents& contents) {
  if (contents.news.empty())
    return;
  const ImVec4 colour = contents.bad_news ? ImVec4(1, 0.5F, 0.4F, 1) : ImVec4(0.5F, 0.9F, 0.5F, 1);
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::TextWrapped("%s", contents.news.c_str());
  ImGui::PopStyleColor();
}

} // namespace

void show_panel(const PanelContents& contents, Settings& settings) {
  ImGui::SetNextWindowPos(ImVec2(8, 8), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize(ImVec2(300, 0));
  ImGui::SetNextWindowBgAlpha(0.8F);
  ImGui::Begin("haarview", nullptr, ImGuiWindowFlags_NoResize);
  ImGui::PushItemWidth(200);
  choose("material", contents.materials, settings.material);
  choose("against", contents.others, settings.against);
  ImGui::SliderFloat("exposure", &settings.exposure, -10, 10, "%+.1f stops");
  ImGui::SliderInt("level", &settings.level, -1, contents.levels,
                   settings.level < 0 ? "as needed" : "%d");
  set_light(contents, settings);
  choose_coarseness(settings.coarseness);
  ImGui::PopItemWidth();
  tell_figures(contents.sides);
  tell_news(contents);
  ImGui::TextDisabled("drag: orbit   right drag: light");
  ImGui::TextDisabled("wheel: size   R: reset   Tab: panel");
  ImGui::End();
}

void show_names(const std::vector<SideFigures>& sides, int width) {
  ImDrawList* const list = ImGui::GetBackgroundDrawList();
  const float breadth = static_cast<float>(width) / static_cast<float>(sides.size());
  const float bottom = ImGui::GetIO().DisplaySize.y - 22;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const char* const name = sides[i].name.c_str();
    const float middle = (static_cast<float>(i) + 0.5F) * breadth;
    const ImVec2 place(middle - ImGui::CalcTextSize(name).x / 2, bottom);
    list->AddText(ImVec2(place.x + 1, place.y + 1), IM_COL32_BLACK, name);
    list->AddText(place, IM_COL32_WHITE, name);
  }
}

} // namespace haarlight::view
