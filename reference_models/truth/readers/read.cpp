// Reads symofros-truth: `read FOLDER` prints each value of each model. c++ -std=c++17 read.cpp -o read; nlohmann/json.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

int main(int count, char **arguments) {
    if (count != 2) {
        std::fputs("usage: read FOLDER, the folder that has manifest.json in it\n", stderr);
        return 1;
    }
    std::set<std::filesystem::path> files;
    for (const auto &entry : std::filesystem::directory_iterator(std::filesystem::path(arguments[1]) / "values"))
        if (entry.path().extension() == ".json") files.insert(entry.path());
    for (const auto &file : files) {
        const auto data = nlohmann::ordered_json::parse(std::ifstream(file));
        for (std::size_t state = 0; state < data["states"].size(); ++state)
            for (const auto &[function, value] : data["states"][state]["values"].items()) {
                std::string shape;
                for (const int size : value["shape"]) shape += (shape.empty() ? "" : "x") + std::to_string(size);
                std::printf("%s %zu %s %s", data["model"].get<std::string>().c_str(), state, function.c_str(),
                            shape.empty() ? "1" : shape.c_str());
                for (const std::string digits : value["digits"]) std::printf(" %.17g", std::stod(digits));
                std::printf("\n");
            }
    }
}
