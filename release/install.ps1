# Installs fakir by copying the files of this archive below a folder: %LOCALAPPDATA%\Programs\fakir, or the one given.
#
#   .\install.ps1 [FOLDER]
#
# Nothing is downloaded, compiled or configured. The list of copied files is FOLDER\share\fakir\installed.txt; removing
# these files uninstalls fakir.
param([string]$Folder = (Join-Path $env:LOCALAPPDATA "Programs\fakir"))
$ErrorActionPreference = "Stop"

$installed = @()
foreach ($file in Get-ChildItem -Recurse -File (Join-Path $PSScriptRoot "bin"), (Join-Path $PSScriptRoot "share")) {
    $path = Join-Path $Folder $file.FullName.Substring($PSScriptRoot.Length + 1)
    New-Item -ItemType Directory -Force (Split-Path $path) | Out-Null
    Copy-Item -Force $file.FullName $path
    $installed += $path
}
$list = Join-Path $Folder "share\fakir\installed.txt"
$installed + $list | Set-Content $list
Write-Output "installed fakir in $Folder"
Write-Output "add $(Join-Path $Folder 'bin') to PATH to run it as fakir"
