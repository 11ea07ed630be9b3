// fuzz_meshes N SEED [FOLDER...]: N mutated mesh files of all formats, read in this process. Each is either refused with an
// InputError or gives a mesh; in the plane its cells nowhere lie on top of each other, which points thrown at random tell. Status 0
// when all do; 1 with the seed of the first that does not. fuzz_meshes --show SEED FOLDER...: that file, on standard output.
#include "read_mesh.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>

#include <unistd.h>

using namespace slipstick;

namespace
{
  constexpr unsigned int seconds_per_mesh = 20; // those are small: a hang
  constexpr unsigned int n_points         = 40; // thrown at every mesh that is taken
  constexpr std::size_t  largest_file     = 20000;

  struct Source
  {
    std::string name, text;
  };

  std::vector<Source> sources_in(const std::vector<std::string> &folders)
  {
    std::vector<Source> sources;
    for (const std::string &folder : folders)
      for (const auto &entry : std::filesystem::directory_iterator(folder))
        {
          const std::string extension = entry.path().extension();
          if (extension != ".msh" && extension != ".inp" && extension != ".vtk" && extension != ".unv" &&
              extension != ".ucd")
            continue;
          std::ifstream      in(entry.path(), std::ios::binary);
          std::ostringstream text;
          text << in.rdbuf();
          if (text.str().size() <= largest_file)
            sources.push_back({entry.path().filename(), text.str()});
        }
    sources.push_back(
      {"plate.inp",
       "*NODE, NSET=ALL\n1, 0, 0\n2, 1, 0\n3, 2, 0\n4, 0, 1\n5, 1, 1\n6, 2, 1\n7, 0, 2\n8, 1, 2\n9, 2, 2\n"
       "*ELEMENT, TYPE=CPS4, ELSET=PLATE\n1, 1,2,5,4\n2, 2,3,6,5\n3, 4,5,8,7\n*ELEMENT, TYPE=CPS3, ELSET=PLATE\n"
       "4, 5,6,9\n5, 5,9,8\n*NSET, NSET=BOTTOM, GENERATE\n1, 3, 1\n*ELSET, ELSET=TOP\n3, 5\n*SURFACE, NAME=UP\n3, S3\n5, S2\n"});
    sources.push_back(
      {"plate.ucd",
       "6 3 0 0 0\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 2 0 0\n6 2 1 0\n1 5 quad 1 2 3 4\n2 6 quad 2 5 6 3\n3 7 line 1 2\n"});
    sources.push_back(
      {"cubes.inp",
       "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n9, 2, 0, 0\n"
       "10, 2, 1, 0\n11, 2, 0, 1\n12, 2, 1, 1\n*ELEMENT, TYPE=C3D8, ELSET=ALL\n1, 1,2,3,4,5,6,7,8\n2, 2,9,10,3,6,11,12,7\n"
       "*NSET, NSET=FOOT\n1, 2, 3, 4, 9, 10\n*SURFACE, NAME=TOP\n1, S2\n2, S2\n"});
    sources.push_back(
      {"tetrahedra.vtk",
       "# vtk DataFile Version 3.0\ntetrahedra\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0\n1 0 0\n"
       "0 1 0\n0 0 1\n1 1 1\nCELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\n"});
    std::sort(sources.begin(), sources.end(), [](const Source &a, const Source &b) { return a.name < b.name; });
    return sources;
  }

  class Mutation
  {
  public:
    Mutation(const std::vector<Source> &all, const unsigned long seed)
      : random(seed)
      , sources(all)
    {
      result = sources[below(sources.size())];
      for (unsigned int n = 1 + below(4); n > 0; --n)
        step();
    }

    std::size_t below(const std::size_t n)
    {
      return n == 0 ? 0 : random() % n;
    }

    std::mt19937_64 random;
    Source          result;

  private:
    /// Begin and length of a word that starts like a number.
    std::pair<std::size_t, std::size_t> number_in(const std::string &text)
    {
      const std::string parts = "0123456789+-.eED";
      for (unsigned int tries = 0; tries < 50; ++tries)
        {
          std::size_t at = text.find_first_of("0123456789", below(text.size()));
          if (at == std::string::npos)
            continue;
          while (at > 0 && parts.find(text[at - 1]) != std::string::npos)
            --at;
          return {at, std::min(text.find_first_not_of(parts, at), text.size()) - at};
        }
      return {0, 0};
    }

    std::pair<std::size_t, std::size_t> line_in(const std::string &text)
    {
      const std::size_t at    = below(text.size());
      const auto        start = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
      const std::size_t begin = start == std::string::npos ? 0 : start + 1;
      return {begin, std::min(text.find('\n', begin), text.size() - 1) + 1 - begin};
    }

    void step()
    {
      static const std::vector<std::string> odd  = {"0",
                                                    "-1",
                                                    "1e308",
                                                    "nan",
                                                    "inf",
                                                    "2147483647",
                                                    "-2147483648",
                                                    "18446744073709551615",
                                                    "1e9",
                                                    "0.5",
                                                    "1e-300",
                                                    "",
                                                    "x",
                                                    "1000000",
                                                    "3",
                                                    "\""};
      std::string                          &text = result.text;
      if (text.empty())
        return;
      switch (below(11))
        {
          case 0: // another number of the file
          case 1:
          case 2:
            {
              const auto from = number_in(text), to = number_in(text);
              text.replace(to.first, to.second, text.substr(from.first, from.second));
              break;
            }
          case 3:
            {
              const auto to = number_in(text);
              text.replace(to.first, to.second, odd[below(odd.size())]);
              break;
            }
          case 4: // moved a little
            {
              const auto to = number_in(text);
              text.replace(to.first,
                           to.second,
                           std::to_string(std::atof(text.substr(to.first, to.second).c_str()) + (below(2) ? .5 : 1)));
              break;
            }
          case 5:
            {
              const auto line = line_in(text);
              text.erase(line.first, line.second);
              break;
            }
          case 6:
            {
              const auto line = line_in(text);
              text.insert(line_in(text).first, text.substr(line.first, line.second));
              break;
            }
          case 7: // two lines change places
            {
              const auto        line  = line_in(text);
              const std::string moved = text.substr(line.first, line.second);
              text.erase(line.first, line.second);
              text.insert(text.empty() ? 0 : line_in(text).first, moved);
              break;
            }
          case 8:
            text.erase(below(text.size()), 1 + below(3));
            break;
          case 9:
            text[below(text.size())] = static_cast<char>(below(256));
            break;
          case 10:
            if (below(4) == 0)
              text.resize(below(text.size()));
            else
              {
                const std::string &other = sources[below(sources.size())].text;
                const auto         piece = line_in(other);
                text.insert(line_in(text).first, other.substr(piece.first, piece.second));
              }
        }
    }

    const std::vector<Source> &sources;
  };

  /// Whether a point lies inside of two cells.
  bool overlaps(const mesh::MeshPiece<2> &piece, std::mt19937_64 &random)
  {
    for (unsigned int k = 0; k < n_points; ++k)
      {
        // inside of a cell
        const auto      &cell = piece.cells[random() % piece.cells.size()];
        dealii::Point<2> x;
        double           sum = 0;
        for (unsigned int v = 0; v < mesh::n_corners<2>(cell); ++v)
          {
            const double weight = .05 + (random() % 1000) / 1000.;
            x += weight * piece.vertices[mesh::corner<2>(cell, v)];
            sum += weight;
          }
        x /= sum;
        unsigned int n = 0;
        for (const auto &other : piece.cells)
          {
            bool is_inside = true;
            for (unsigned int v = 0; v < mesh::n_corners<2>(other); ++v)
              {
                const auto a      = piece.vertices[mesh::corner<2>(other, v)],
                           b      = piece.vertices[mesh::corner<2>(other, v + 1)];
                const double area = (b[0] - a[0]) * (x[1] - a[1]) - (b[1] - a[1]) * (x[0] - a[0]);
                is_inside         = is_inside && area > 1e-3 * (b - a).norm_square(); // slits may be off by 1e-4
              }
            n += is_inside;
          }
        if (n > 1)
          return true;
      }
    return false;
  }

  unsigned long present_seed = 0;

  void too_slow(int)
  {
    std::cerr << "seed " << present_seed << " takes more than " << seconds_per_mesh << " s" << std::endl;
    _exit(1);
  }
} // namespace

int main(int argc, char **argv)
{
  std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 2)
    {
      std::cerr << "fuzz_meshes N SEED FOLDER... or fuzz_meshes --show SEED FOLDER..." << std::endl;
      return 2;
    }
  const auto          sources = sources_in({words.begin() + 2, words.end()});
  const unsigned long seed    = std::stoul(words[1]);
  if (words[0] == "--show")
    {
      const Mutation mutation(sources, seed);
      std::cerr << mutation.result.name << std::endl;
      std::cout << mutation.result.text;
      return 0;
    }
  signal(SIGALRM, too_slow);
  const unsigned long n     = std::stoul(words[0]);
  unsigned long       taken = 0;
  for (present_seed = seed; present_seed < seed + n; ++present_seed)
    {
      Mutation mutation(sources, present_seed);
      alarm(seconds_per_mesh);
      try
        {
          const auto file = mesh::parse_mesh_file(mutation.result.name, mutation.result.text);
          if (file.dimension() == 3)
            {
              fuzz::whole_body<3>(file);
              ++taken;
              continue;
            }
          const auto mesh = fuzz::whole_body<2>(file);
          ++taken;
          if (overlaps(mesh.piece, mutation.random))
            {
              std::cerr << "seed " << present_seed << " (" << mutation.result.name
                        << "): cells on top of each other were taken" << std::endl;
              return 1;
            }
        }
      catch (const InputError &error)
        {
          if (!fuzz::has_remedy(error))
            {
              std::cerr << "seed " << present_seed << ": no remedy: " << error.what() << std::endl;
              return 1;
            }
        }
      catch (const std::exception &error)
        {
          std::cerr << "seed " << present_seed << " (" << mutation.result.name << "): " << error.what() << std::endl;
          return 1;
        }
    }
  std::cout << n << " mutated meshes from seed " << seed << ": " << taken << " taken, " << n - taken << " refused"
            << std::endl;
  return 0;
}
